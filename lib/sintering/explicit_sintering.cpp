// explicit_sintering.cpp: forces by pair, accelerations by particle, steps at the stability limit.
#include "sintering/explicit_sintering.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "physics/materials.h"
#include "sintering/die.h"

namespace kiln::sintering {

namespace {

constexpr double stability_fraction = 0.5;    // of the longest stable step
constexpr double max_approach = 1e-3;   // of the mean radius, of any gap in a step
constexpr double list_margin = 0.1;        // of the mean radius
constexpr double record_change = 2e-3;     // of the density's logarithm, after which a record is due
constexpr int max_steps = 500;            // in a record
constexpr int max_bisections = 100;
constexpr double landing_accuracy = 1e-9;
constexpr std::size_t chunk = 1024;        // particles whose sums are formed together; fixed, so that sums do not depend on threads

}  // namespace

ExplicitSintering::ExplicitSintering(State state, const SinteringSettings& settings) : SinteringMethod(std::move(state), settings) {
    if (settings_.coarsening.any()) throw Error("the explicit method has no coarsening");
    if (kinetics_.any_rigid()) throw Error("the explicit method has no law for pairs of materials that do not diffuse");
    const State& working = body_.working();
    for (std::size_t kind = 0; kind < working.materials.size() * working.materials.size(); ++kind)
        if (std::isfinite(kinetics_.neck_limit(kind)))
            throw Error("the explicit method has no law for the dihedral limit of a neck");
    const Particles& particles = body_.particles();
    for (std::size_t row = 0; row < body_.size(); ++row) {
        const Material& material = working.materials[static_cast<std::size_t>(particles.material[row])];
        const double radius = particles.radius[row];
        mass_.push_back(settings_.mass_scaling * physics::required(material.density, material, "density") * sphere_volume(radius));
        box_inertia_ += Vec3::Constant(mass_.back() * 4.0 * radius * radius);
    }
    velocity_.assign(body_.size(), Vec3::Zero());
    acceleration_ = velocity_;
    damping_.assign(body_.size(), 0.0);
}

void ExplicitSintering::list_pairs() {
    body_.list_pairs(0.5 * list_margin * body_.mean_radius());
    pairs_ = body_.pairs();
    force_.resize(pairs_.size());
    sides_ = group_by<std::int32_t>(body_.size(), [&](const auto& visit) {
        for (std::size_t row = 0; row < pairs_.size(); ++row) {
            visit(static_cast<std::size_t>(pairs_[row].i), static_cast<std::int32_t>(row));
            visit(static_cast<std::size_t>(pairs_[row].j), -1 - static_cast<std::int32_t>(row));
        }
    });
    first_row_.assign(body_.size() + 1, 0);
    for (const Pair& pair : pairs_) ++first_row_[static_cast<std::size_t>(pair.i) + 1];
    for (std::size_t particle = 0; particle < body_.size(); ++particle) first_row_[particle + 1] += first_row_[particle];
}

ExplicitSintering::PairForce ExplicitSintering::pair_force(const Pair& pair, const std::vector<double>& diffusion) const {
    const auto i = static_cast<std::size_t>(pair.i), j = static_cast<std::size_t>(pair.j);
    const Vec3 vector = body_.vector(pair);
    const double distance = vector.norm();
    const auto [first, second] = body_.radii(pair);
    const double overlap = contact_overlap(first, second, distance - body_.offset(pair));
    PairForce result;
    if (overlap < 0.0) return result;
    const Vec3 normal = vector / distance;
    const Vec3 opening = velocity_[j] - velocity_[i] + strain_rate_.cwiseProduct(vector);
    const std::size_t kind = kinetics_.row(body_.particles(), pair);
    const double reduced = physics::reduced_radius(first, second);
    result.viscosity =
        physics::normal_viscosity_factor(settings_.constants, reduced) * physics::viscosity_shape(overlap) / diffusion[kind];
    const double shear = physics::tangential_viscosity(settings_.constants, overlap, reduced) / diffusion[kind];
    const double along = normal.dot(opening);
    result.force =
        (physics::sintering_force(settings_.constants, reduced, kinetics_.surface_energy(kind)) + result.viscosity * along) *
            normal +
        shear * (opening - along * normal);
    result.viscosity += shear;
    return result;
}

ExplicitSintering::BoxForce ExplicitSintering::find_forces(const std::vector<double>& diffusion) {
    // Sums go by particles: pairs in the list that do not touch add zeros, so the result does not depend on how far the list
    // reaches.
    const std::size_t chunks = (body_.size() + chunk - 1) / chunk;
    std::vector<BoxForce> parts(chunks);
    for_chunks(chunks, [&](std::size_t part) {
        for (std::size_t row = first_row_[part * chunk]; row < first_row_[std::min(body_.size(), (part + 1) * chunk)]; ++row) {
            force_[row] = pair_force(pairs_[row], diffusion);
            const Vec3 vector = body_.vector(pairs_[row]);
            parts[part].force += force_[row].force.cwiseProduct(vector);
            parts[part].viscosity += force_[row].viscosity * vector.cwiseAbs2();
        }
    }, worth_threads / chunk);
    for_rows(body_.size(), [&](std::size_t particle) {
        Vec3 sum = Vec3::Zero();
        double viscosity = 0.0;
        for (const std::int32_t side : sides_.of(particle)) {
            const bool second = side < 0;
            const PairForce& pair = force_[static_cast<std::size_t>(second ? -1 - side : side)];
            sum += second ? Vec3(-pair.force) : pair.force;
            viscosity += pair.viscosity;
        }
        acceleration_[particle] = sum / mass_[particle];
        damping_[particle] = viscosity / mass_[particle];
    });
    BoxForce total;
    for (const BoxForce& part : parts) {
        total.force += part.force;
        total.viscosity += part.viscosity;
    }
    return total;
}

double ExplicitSintering::stable_step(const BoxForce& box) const {
    // dv/dt = -D v is stable for steps below 2/D; D of a network is at most twice the largest sum of viscosities over mass.
    const auto greatest = [&](const auto& value) { return greatest_of_rows(body_.size(), 0.0, value); };
    double fastest = greatest([&](std::size_t particle) { return 2.0 * damping_[particle]; });
    const double speed = greatest([&](std::size_t particle) { return velocity_[particle].norm(); });
    const double push = greatest([&](std::size_t particle) { return acceleration_[particle].norm(); });
    for (int axis = 0; axis < 3; ++axis) fastest = std::max(fastest, box.viscosity[axis] / box_inertia_[axis]);
    const double length = max_approach * body_.mean_radius();
    double step = fastest > 0.0 ? stability_fraction * 2.0 / fastest : std::numeric_limits<double>::infinity();
    if (speed > 0.0) step = std::min(step, 0.5 * length / speed);
    if (push > 0.0) step = std::min(step, std::sqrt(length / push));
    return step;
}

void ExplicitSintering::accelerate(const BoxForce& box, double step) {
    for_rows(body_.size(), [&](std::size_t particle) { velocity_[particle] += step * acceleration_[particle]; });
    const double volume = body_.box().volume();
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto k = static_cast<Eigen::Index>(axis);
        if (!body_.box().periodic[axis] || settings_.fixed[axis]) continue;
        strain_rate_[k] -= step * (box.force[k] + settings_.pressure[k] * volume) / box_inertia_[k];
        if (settings_.confined[axis] && die_gap(body_.strain())[k] == 0.0) strain_rate_[k] = std::min(strain_rate_[k], 0.0);
    }
}

Motion ExplicitSintering::motion_over(double step) const {
    Motion motion(body_.size());
    for (std::size_t particle = 0; particle < body_.size(); ++particle)
        Eigen::Map<Vec3>(&motion.displacement[3 * particle]) = step * velocity_[particle];
    motion.strain = step * strain_rate_;
    Die(settings_.confined, {}, die_gap(body_.strain())).confine(motion.strain);
    return motion;
}

double ExplicitSintering::shortened(double step, double log_change) const {
    double low = 0.0, high = step;  // the density at the end of the step grows with its length
    for (int halving = 0; halving < max_bisections; ++halving) {
        const double middle = 0.5 * (low + high), miss = body_.log_density_change(motion_over(middle)) - log_change;
        if (std::abs(miss) < landing_accuracy) return middle;
        (miss > 0.0 ? high : low) = middle;
    }
    return 0.5 * (low + high);
}

void ExplicitSintering::step_once(double latest_time, double highest_density, StepRecord& record) {
    if (body_.min_margin() < max_approach * body_.mean_radius()) list_pairs();
    const double now = body_.time();
    const BoxForce box = find_forces(kinetics_.diffusion_at(kinetics_.schedule().temperature(now)));
    double step = stable_step(box);
    const bool on_time = step >= latest_time - now;
    if (on_time) step = latest_time - now;
    if (!std::isfinite(step)) throw Error("no contact drives any motion, so no density can be waited for");
    accelerate(box, step);
    const double wanted_change = std::log(highest_density / body_.density());
    Motion motion = motion_over(step);
    double until = on_time ? latest_time : now + step;
    if (body_.log_density_change(motion) > wanted_change) {
        step = shortened(step, wanted_change);
        motion = motion_over(step);
        until = now + step;
    }
    record.stress = box.force / body_.box().volume();
    body_.apply(motion, until, kinetics_.schedule().temperature(until));
}

StepRecord ExplicitSintering::advance(double latest_time, double highest_density) {
    if (pairs_.empty()) list_pairs();
    const double start = body_.time(), density = body_.density();
    StepRecord record;
    for (int step = 0; step < max_steps; ++step) {
        if (step > 0 && settings_.stop && settings_.stop()) break;  // the step that is done stands
        step_once(latest_time, highest_density, record);
        ++record.attempts;
        const bool reached =
            body_.time() >= latest_time || body_.density() >= highest_density * (1.0 - 2.0 * landing_accuracy);
        if (reached || std::abs(std::log(body_.density() / density)) > record_change) break;
    }
    steps_ += static_cast<std::size_t>(record.attempts);
    record.time = body_.time();
    record.duration = record.time - start;
    record.temperature = *body_.working().temperature;
    record.relative_density = body_.density();
    record.strain = body_.strain();
    record.contacts = body_.statistics();
    return record;
}

Numbers ExplicitSintering::numbers() const { return {{"strain_rate", triple(strain_rate_)}}; }

std::vector<NamedArray> ExplicitSintering::arrays() const {
    return {{"velocity", {{body_.size(), 3}, motion_over(1.0).displacement}}};
}

void ExplicitSintering::take_up(const Numbers& numbers, const std::vector<NamedArray>& arrays) {
    const std::vector<double> velocity = column_of(arrays, "velocity", body_.size());
    for (std::size_t particle = 0; particle < body_.size(); ++particle)
        velocity_[particle] = Eigen::Map<const Vec3>(&velocity[3 * particle]);
    strain_rate_ = triple_at(numbers, "strain_rate");
    list_pairs();
}

}  // namespace kiln::sintering
