// sintering.cpp: the loop around the implicit step.
#include "numerics/sintering.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/spatial_order.h"
#include "physics/diffusion.h"
#include "physics/materials.h"

namespace kiln::numerics {

namespace {

constexpr double list_margin = 0.06;           // of a radius, that the list of pairs reaches beyond touch
constexpr double largest_closing = 1.0;        // of the mean radius, of any gap in a step
constexpr double largest_log_step = 0.05;      // of the density
constexpr double first_closing = 2e-3;         // of the radius, in the first step, by the pair law
constexpr double third_order_factor = 3.0;     // error of the second-order step over (difference of the orders times log step)
constexpr double typical_log_range = 0.4;      // of a whole run, over which the tolerance is spread
constexpr double coincident = 1e-9;            // of the radii, distance of centres that has no direction
constexpr std::size_t most_idle_steps = 100;
constexpr double idle = 1e-10;                 // log density change of an idle step

constexpr double landing_solver = 0.05;  // tolerance of the solver there, over that of other steps
constexpr int most_landings = 40;    // attempts to end a step at a wanted density
constexpr int most_rejections = 20;  // of one step

}  // namespace

Sintering::Sintering(State state, const SinteringSettings& settings) : state_(std::move(state)), settings_(settings) {
    Particles& particles = state_.particles;
    if (particles.size() == 0) throw Error("the state has no particles");
    if (state_.bonds) throw Error("the state has bonds; sintering takes a packing without them");
    largest_radius_ = *std::max_element(particles.radius.begin(), particles.radius.end());
    mean_radius_ = std::cbrt(particle_volume(particles) / static_cast<double>(particles.size()) * 0.75 / std::numbers::pi);
    order_ = spatial_order(state_.box, particles.position, 2.0 * largest_radius_);
    particles = take_rows(particles, order_);
    for (Vec3& position : particles.position) position = state_.box.wrap(position);
    for (std::size_t axis = 0; axis < 3; ++axis)
        free_axis_[axis] = state_.box.periodic[axis];

    std::vector<double> diffusion, energy;
    for (const Material& material : state_.materials) {
        diffusion.push_back(physics::diffusion_parameter_of(material, settings_.temperature));
        energy.push_back(physics::required(material.surface_energy, material, "surface_energy"));
    }
    for (std::size_t a = 0; a < diffusion.size(); ++a)
        for (std::size_t b = 0; b < diffusion.size(); ++b) {
            diffusion_.push_back(physics::mixed_diffusion_parameter(diffusion[a], diffusion[b]));
            energy_.push_back(physics::mixed_surface_energy(energy[a], energy[b]));
        }
    for (const MaterialPair& pair : state_.contacts)
        for (const auto& [a, b] : {std::pair(pair.materials[0], pair.materials[1]), std::pair(pair.materials[1], pair.materials[0])}) {
            const std::size_t row = static_cast<std::size_t>(a) * diffusion.size() + static_cast<std::size_t>(b);
            if (pair.diffusion_parameter) diffusion_[row] = *pair.diffusion_parameter;
            if (pair.surface_energy) energy_[row] = *pair.surface_energy;
        }
    for (const double value : diffusion_)
        if (!(value > 0.0)) throw Error("a diffusion parameter of zero (a rigid material) is not supported");
    density_ = kiln::relative_density(state_);
    state_.temperature = settings_.temperature;
    find_pairs_with_margin(0.0);
    next_duration_ = first_duration();
}

double Sintering::diffusion_over(std::int32_t a, std::int32_t b, double duration) const {
    return diffusion_[static_cast<std::size_t>(a) * state_.materials.size() + static_cast<std::size_t>(b)] * duration;
}

void Sintering::find_pairs_with_margin(double closing) {
    const Particles& particles = state_.particles;
    margin_left_ = std::max(list_margin * mean_radius_, 1.5 * closing);
    std::vector<double> reach = particles.radius;
    for (double& each : reach) each += 0.5 * margin_left_;
    pairs_ = find_pairs(state_.box, particles.position, reach);
    for (const Pair& pair : pairs_) {
        const double radii = particles.radius[static_cast<std::size_t>(pair.i)] + particles.radius[static_cast<std::size_t>(pair.j)];
        if (pair_vector(state_.box, particles.position, pair).norm() < coincident * radii)
            throw Error("the centres of particles " + std::to_string(particles.id[static_cast<std::size_t>(pair.i)]) + " and " +
                        std::to_string(particles.id[static_cast<std::size_t>(pair.j)]) + " coincide");
    }
}

void Sintering::fill_pair_steps(double duration) {
    const Particles& particles = state_.particles;
    const std::vector<Pair>& pairs = pairs_;
    pair_steps_.resize(pairs.size());
#pragma omp parallel for schedule(static)
    for (std::size_t row = 0; row < pairs.size(); ++row) {
        const auto i = static_cast<std::size_t>(pairs[row].i), j = static_cast<std::size_t>(pairs[row].j);
        PairStep& step = pair_steps_[row];
        step.vector = pair_vector(state_.box, particles.position, pairs[row]);
        step.distance = step.vector.norm();
        step.overlap = particles.radius[i] + particles.radius[j] - step.distance;
        step.reduced_radius = physics::reduced_radius(particles.radius[i], particles.radius[j]);
        const std::int32_t a = particles.material[i], b = particles.material[j];
        const double energy = energy_[static_cast<std::size_t>(a) * state_.materials.size() + static_cast<std::size_t>(b)];
        step.force = physics::sintering_force(settings_.step.constants, step.reduced_radius, energy);
        step.diffusion = diffusion_over(a, b, duration);
        step.cubic = physics::normal_viscosity_factor(settings_.step.constants, step.reduced_radius) / step.diffusion;
    }
}

double Sintering::first_duration() {
    fill_pair_steps(1.0);  // of one second
    double shortest = std::numeric_limits<double>::infinity();
    double overlap = 0.0;
    std::size_t contacts = 0;
    for (const PairStep& step : pair_steps_)
        if (step.overlap >= 0.0) {
            overlap += step.overlap / step.reduced_radius;
            ++contacts;
        }
    if (contacts > 0) overlap /= static_cast<double>(contacts);
    for (const PairStep& step : pair_steps_) {  // time in which a pair of mean overlap closes by first_closing
        const double start = overlap * step.reduced_radius, end = start + 2.0 * first_closing * step.reduced_radius;
        shortest = std::min(shortest, step.cubic * (end * end * end - start * start * start) / (3.0 * step.force));
    }
    return std::isfinite(shortest) ? shortest : 1.0;
}

double Sintering::log_density_change(const Motion& motion) const {
    return -std::log1p(motion.strain[0]) - std::log1p(motion.strain[1]) - std::log1p(motion.strain[2]);
}

double Sintering::closing_bound(const Motion& motion) const {
    double largest = 0.0;
#pragma omp parallel for schedule(static) reduction(max : largest)
    for (std::size_t row = 0; row < state_.particles.size(); ++row)
        largest = std::max(largest, Eigen::Map<const Vec3>(&motion.displacement[3 * row]).norm());
    return 2.0 * largest + motion.strain.cwiseAbs().maxCoeff() * (2.0 * largest_radius_ + margin_left_);
}

Eigen::Matrix3d Sintering::allowed_strain() const {
    // Along an axis that no contacts reach through, nothing resists or drives a strain: it follows the mean of the axes that contacts
    // do reach through, so that loose clusters move with the flow of the whole.
    const std::array<bool, 3> percolates = percolating_axes(state_.particles.size(), touching_);
    std::vector<Vec3> basis;
    Vec3 followers = Vec3::Zero();
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const Vec3 along = Vec3::Unit(static_cast<Eigen::Index>(axis));
        if (free_axis_[axis] && percolates[axis]) basis.push_back(along);
        if (free_axis_[axis] && !percolates[axis]) followers += along;
    }
    if (basis.empty()) return Eigen::Matrix3d::Zero();
    Eigen::MatrixXd columns(3, basis.size());
    for (std::size_t k = 0; k < basis.size(); ++k)
        columns.col(static_cast<Eigen::Index>(k)) = basis[k] + followers / static_cast<double>(basis.size());
    return columns * (columns.transpose() * columns).ldlt().solve(columns.transpose());
}

Sintering::Trial Sintering::attempt(double duration, bool tight) {
    StepSettings settings = settings_.step;
    if (tight) settings.solver_tolerance *= landing_solver;
    ++attempts_;
    double closing = last_duration_ > 0.0 ? 1.2 * last_closing_ * std::max(1.0, duration / last_duration_) : 0.5 * margin_left_;
    closing = std::min(closing, largest_closing * mean_radius_);
    for (;;) {
        if (margin_left_ < closing) find_pairs_with_margin(closing);
        fill_pair_steps(duration);
        active_.clear();
        active_steps_.clear();
        for (std::size_t row = 0; row < pairs_.size(); ++row) {
            if (pair_steps_[row].overlap <= -closing) continue;
            active_.push_back(pairs_[row]);
            active_steps_.push_back(pair_steps_[row]);
        }
        touching_.clear();
        for (std::size_t row = 0; row < active_.size(); ++row)
            if (active_steps_[row].overlap >= 0.0) touching_.push_back(active_[row]);
        settings.allowed_strain = allowed_strain();
        SinterStep solver(state_.box, state_.particles.position, active_, settings);
        Trial trial;
        trial.report = solver.solve(active_steps_, trial.motion, trial.first_order);
        newton_ += trial.report.newton;
        conjugate_gradients_ += trial.report.conjugate_gradients;
        const double reached = closing_bound(trial.motion);
        if (reached > largest_closing * mean_radius_) {  // no list of pairs is made for such a leap: the step is too long
            trial.report.converged = false;
            trial.closing = reached;
            return trial;
        }
        if (reached > closing) {  // pairs that were left out might have come to touch
            closing = 1.2 * reached;
            continue;
        }
        trial.closing = reached;
        trial.log_density = log_density_change(trial.motion);
        trial.first_log_density = log_density_change(trial.first_order);
        return trial;
    }
}

Sintering::Trial Sintering::land_on(double log_change, double& duration, const Trial& beyond) {
    // The density is a smooth function of the step's length: secants, kept inside the bracket.
    double low = 0.0, high = duration;
    double before = 0.0, before_miss = -log_change, here = duration, miss = beyond.log_density - log_change;
    Trial trial;
    for (int iteration = 0; iteration < most_landings; ++iteration) {
        const double secant = here - miss * (here - before) / (miss - before_miss);
        before = here;
        before_miss = miss;
        here = secant > low && secant < high ? secant : 0.5 * (low + high);
        trial = attempt(here, true);
        miss = trial.log_density - log_change;
        if (std::abs(miss) <= settings_.density_accuracy) break;
        (miss > 0.0 ? high : low) = here;
    }
    duration = here;
    return trial;
}

void Sintering::apply(const Trial& trial, double duration) {
    Box& box = state_.box;
    const Vec3 stretch = Vec3::Ones() + trial.motion.strain;
    std::vector<Vec3>& position = state_.particles.position;
    for (std::size_t row = 0; row < position.size(); ++row)
        position[row] = box.origin + stretch.cwiseProduct(position[row] - box.origin) +
                        Eigen::Map<const Vec3>(&trial.motion.displacement[3 * row]);
    box.lengths = box.lengths.cwiseProduct(stretch);
    strain_ += stretch.array().log().matrix();
    state_.time += duration;
    density_ = kiln::relative_density(state_);
    margin_left_ -= trial.closing;
    last_closing_ = trial.closing;
    last_duration_ = duration;
}

StepRecord Sintering::advance(double latest_time, double highest_density) {
    const double wanted_change = std::log(highest_density / density_);
    double duration = std::min(next_duration_, latest_time - state_.time);
    const bool ends_on_time = duration < next_duration_;
    const double wanted_error = settings_.tolerance / (third_order_factor * typical_log_range);
    Trial trial;
    double difference = 0.0;
    for (int rejected = 0;; ++rejected) {
        trial = attempt(duration, false);
        difference = std::abs(trial.log_density - trial.first_log_density);
        if (difference <= 2.0 * wanted_error && std::abs(trial.log_density) <= largest_log_step && trial.report.converged) break;
        if (rejected == most_rejections) break;  // the record says that it did not converge
        duration *= std::clamp(0.8 * std::sqrt(wanted_error / std::max(difference, 1e-300)), 0.2, 0.7);
    }
    const double growth = std::clamp(0.9 * std::sqrt(wanted_error / std::max(difference, 1e-300)), 0.5, 2.5);
    next_duration_ = ends_on_time && duration < next_duration_ ? std::max(next_duration_, duration * growth) : duration * growth;
    const double room = 0.8 * largest_log_step / std::max(std::abs(trial.log_density), 1e-300);
    next_duration_ = std::min(next_duration_, duration * std::max(room, 0.5));

    if (trial.log_density > wanted_change) {
        trial = land_on(wanted_change, duration, trial);
        difference = std::abs(trial.log_density - trial.first_log_density);
    }
    idle_steps_ = std::abs(trial.log_density) < idle ? idle_steps_ + 1 : 0;
    if (idle_steps_ > most_idle_steps && std::isfinite(highest_density))
        throw Error("the density stays at " + std::to_string(density_) + "; no contact is left that densifies the box, so " +
                    std::to_string(highest_density) + " cannot be reached");
    apply(trial, duration);
    ++steps_;
    error_ += third_order_factor * difference * std::abs(trial.log_density);
    return {.time = state_.time,
            .duration = duration,
            .relative_density = density_,
            .strain = strain_,
            .contacts = contact_statistics(state_.box, state_.particles, pairs_),
            .error = error_,
            .attempts = std::exchange(attempts_, 0),
            .newton = std::exchange(newton_, 0),
            .conjugate_gradients = std::exchange(conjugate_gradients_, 0),
            .converged = trial.report.converged};
}

State Sintering::state() const {
    State result = state_;
    std::vector<std::int32_t> back(order_.size());
    for (std::size_t row = 0; row < order_.size(); ++row) back[static_cast<std::size_t>(order_[row])] = static_cast<std::int32_t>(row);
    result.particles = take_rows(state_.particles, back);
    for (Vec3& position : result.particles.position) position = result.box.wrap(position);
    return result;
}

}  // namespace kiln::numerics
