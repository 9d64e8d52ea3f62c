// sintering_body.cpp: memory order, the list of pairs with its margin, and the body's extent along free faces.
#include "sintering/sintering_body.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/spatial_order.h"

namespace kiln::sintering {

namespace {

constexpr double list_margin = 0.15;    // of the mean radius, that a particle may travel before pairs are listed anew
constexpr double margin_ahead = 2.0;    // of the travel of a fast particle, that the margin leaves
constexpr std::size_t few = 100;        // of so many particles one may need a new list and the others keep theirs
constexpr double coincident = 1e-9;   // of the radii, distance of centres that has no direction

}  // namespace

SinteringBody::SinteringBody(State state, Faces faces) : state_(std::move(state)) {
    Particles& particles = state_.particles;
    if (particles.size() == 0) throw Error("the state has no particles");
    if (state_.bonds && state_.bonds->size() > 0) throw Error("the state has bonds; sintering takes a packing without them");
    state_.bonds.reset();
    for (Vec3& position : particles.position) position = state_.box.wrap(position);
    if (faces != Faces::as_given) state_.box.periodic.fill(faces == Faces::periodic);
    max_radius_ = *std::max_element(particles.radius.begin(), particles.radius.end());
    solid_ = particle_volume(particles);
    mean_radius_ = std::cbrt(solid_ / static_cast<double>(particles.size()) * 0.75 / std::numbers::pi);
    order_ = spatial_order(state_.box, particles.position, 2.0 * max_radius_);
    particles = take_rows(particles, order_);
    density_ = solid_ / state_.box.volume();
    list_pairs(list_margin * mean_radius_);
}

void SinteringBody::list_pairs(double margin) {
    margin_.assign(size(), margin);
    find_pairs();
}

std::vector<double> SinteringBody::reaches() const {
    std::vector<double> reach = state_.particles.radius;
    for (std::size_t row = 0; row < size(); ++row) reach[row] += std::max(margin_[row], 0.0);
    return reach;
}

void SinteringBody::find_pairs() {
    pairs_ = kiln::find_pairs(state_.box, state_.particles.position, reaches());
    took_list();
}

/// Lists the pairs of a few particles anew: the others' margins and pairs among themselves hold on.
void SinteringBody::find_pairs_of(const std::vector<std::int32_t>& few) {
    const std::vector<Pair> of_few = kiln::find_pairs(state_.box, state_.particles.position, reaches(), few);
    std::vector<std::uint8_t> listed(size(), 0);
    for (const std::int32_t row : few) listed[static_cast<std::size_t>(row)] = 1;
    std::erase_if(pairs_, [&](const Pair& pair) {
        return listed[static_cast<std::size_t>(pair.i)] != 0 || listed[static_cast<std::size_t>(pair.j)] != 0;
    });
    const auto others = static_cast<std::ptrdiff_t>(pairs_.size());
    pairs_.insert(pairs_.end(), of_few.begin(), of_few.end());
    std::inplace_merge(pairs_.begin(), pairs_.begin() + others, pairs_.end());
    took_list();
}

void SinteringBody::took_list() {
    const Particles& particles = state_.particles;
    min_margin_ = *std::min_element(margin_.begin(), margin_.end());
    ++lists_;
    for (const Pair& pair : pairs_) {
        const auto [first, second] = radii(pair);
        if (vector(pair).norm() < coincident * (first + second))
            throw Error("the centres of particles " + std::to_string(particles.id[static_cast<std::size_t>(pair.i)]) + " and " +
                        std::to_string(particles.id[static_cast<std::size_t>(pair.j)]) + " coincide");
    }
}

/// Bound of what a particle's motion takes off the gaps to particles beyond its margin, m: they close by no more than both travel.
double SinteringBody::travel(std::size_t row, const Motion& motion) const {
    return Eigen::Map<const Vec3>(&motion.displacement[3 * row]).norm() +
           motion.strain.cwiseAbs().maxCoeff() * (state_.particles.radius[row] + margin_[row]);
}

void SinteringBody::cover(const Motion& motion, double factor) {
    std::vector<std::uint8_t> beyond(size());
    std::size_t count = 0;
#pragma omp parallel for schedule(static) reduction(+ : count) if (size() >= worth_threads)
    for (std::size_t row = 0; row < size(); ++row) count += beyond[row] = factor * travel(row, motion) > margin_[row];
    if (count == 0) return;
    const bool all = count > size() / few;
    std::vector<std::int32_t> rows;
    for (std::size_t row = 0; row < size(); ++row) {
        if (!all && beyond[row] == 0) continue;
        margin_[row] = std::clamp(margin_ahead * factor * travel(row, motion), list_margin * mean_radius_, mean_radius_);
        rows.push_back(static_cast<std::int32_t>(row));
    }
    all ? find_pairs() : find_pairs_of(rows);
}

double SinteringBody::approach_bound(const Motion& motion) const {
    double largest = 0.0;
#pragma omp parallel for schedule(static) reduction(max : largest) if (size() >= worth_threads)
    for (std::size_t row = 0; row < size(); ++row)
        largest = std::max(largest, Eigen::Map<const Vec3>(&motion.displacement[3 * row]).norm());
    return 2.0 * largest + motion.strain.cwiseAbs().maxCoeff() * 2.0 * max_radius_;
}

Vec3 SinteringBody::body_stretch(const Motion& motion) const {
    const Particles& particles = state_.particles;
    const auto& periodic = state_.box.periodic;
    Vec3 stretch = Vec3::Ones();
    if (periodic[0] && periodic[1] && periodic[2]) return stretch;
    double mass = 0.0;
    Vec3 sum = Vec3::Zero(), square = Vec3::Zero(), sum_after = Vec3::Zero(), square_after = Vec3::Zero();
    for (std::size_t row = 0; row < size(); ++row) {  // about the first particle, so that squares keep their digits
        const double m = particles.radius[row] * particles.radius[row] * particles.radius[row];
        const Vec3 before = particles.position[row] - particles.position[0];
        const Vec3 after = before + Eigen::Map<const Vec3>(&motion.displacement[3 * row]);
        mass += m;
        sum += m * before;
        square += m * before.cwiseProduct(before);
        sum_after += m * after;
        square_after += m * after.cwiseProduct(after);
    }
    const Vec3 spread = square / mass - (sum / mass).cwiseAbs2(),
               spread_after = square_after / mass - (sum_after / mass).cwiseAbs2();
    const double least = 1e-12 * max_radius_ * max_radius_;  // a body of one layer does not shrink across it
    for (int axis = 0; axis < 3; ++axis)
        if (!periodic[static_cast<std::size_t>(axis)] && spread[axis] > least)
            stretch[axis] = std::sqrt(spread_after[axis] / spread[axis]);
    return stretch;
}

double SinteringBody::log_density_change(const Motion& motion) const {
    return -std::log1p(motion.strain[0]) - std::log1p(motion.strain[1]) - std::log1p(motion.strain[2]) -
           body_stretch(motion).array().log().sum();
}

void SinteringBody::apply(const Motion& motion, double until, double temperature) {
    Box& box = state_.box;
    const Vec3 body = body_stretch(motion);
    const Vec3 stretch = Vec3::Ones() + motion.strain;
    double least = std::numeric_limits<double>::infinity();
#pragma omp parallel for schedule(static) reduction(min : least) if (size() >= worth_threads)
    for (std::size_t row = 0; row < size(); ++row) {
        margin_[row] -= travel(row, motion);
        least = std::min(least, margin_[row]);
        Vec3& position = state_.particles.position[row];
        position = box.origin + stretch.cwiseProduct(position - box.origin) + Eigen::Map<const Vec3>(&motion.displacement[3 * row]);
    }
    const Vec3 middle = box.origin + 0.5 * box.lengths, both = stretch.cwiseProduct(body);
    for (int axis = 0; axis < 3; ++axis)  // a free body's box shrinks towards its middle, a periodic one towards its origin
        if (!box.periodic[static_cast<std::size_t>(axis)]) box.origin[axis] = middle[axis] - 0.5 * body[axis] * box.lengths[axis];
    box.lengths = box.lengths.cwiseProduct(both);
    strain_ += both.array().log().matrix();
    state_.time = until;
    state_.temperature = temperature;
    density_ = solid_ / state_.box.volume();
    min_margin_ = least;
}

State SinteringBody::state() const {
    State result = state_;
    std::vector<std::int32_t> back(order_.size());
    for (std::size_t row = 0; row < order_.size(); ++row)
        back[static_cast<std::size_t>(order_[row])] = static_cast<std::int32_t>(row);
    result.particles = take_rows(state_.particles, back);
    for (Vec3& position : result.particles.position) position = result.box.wrap(position);
    return result;
}

void SinteringBody::restore(const Box& box, std::vector<Vec3> position, double time, double temperature, const Vec3& strain) {
    state_.box = box;
    state_.particles.position = std::move(position);
    state_.time = time;
    state_.temperature = temperature;
    strain_ = strain;
    density_ = solid_ / state_.box.volume();
    list_pairs(list_margin * mean_radius_);
}

}  // namespace kiln::sintering
