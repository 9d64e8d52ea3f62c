// structure.cpp: contacts, clusters and density of a state.
#include "analysis/structure.h"

#include <algorithm>
#include <functional>
#include <numbers>
#include <numeric>

#include "analysis/envelope.h"
#include "physics/recorded_necks.h"
#include "physics/sinter_contact.h"

namespace kiln::analysis {

namespace {

constexpr double min_width = 3.0;  // of the inner region, in mean diameters

/// Volume of each particle with half of each of its bonds, m3.
std::vector<double> solid_volumes(const State& state) {
    std::vector<double> volume(state.particles.size());
    for (std::size_t row = 0; row < volume.size(); ++row) {
        const double radius = state.particles.radius[row];
        volume[row] = 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
    }
    if (!state.bonds) return volume;
    for (std::size_t bond = 0; bond < state.bonds->size(); ++bond)
        for (const std::int32_t row : state.bonds->pair[bond])
            volume[static_cast<std::size_t>(row)] += 0.5 * state.bonds->volume[bond];
    return volume;
}

}  // namespace

std::vector<Pair> contacts_of(const State& state) {
    if (!state.bonds) return physics::recorded_contacts(state).pairs;
    std::vector<Pair> contacts;
    for (std::size_t bond = 0; bond < state.bonds->size(); ++bond)
        contacts.push_back({state.bonds->pair[bond][0], state.bonds->pair[bond][1], state.bonds->image[bond]});
    return contacts;
}

std::vector<double> overlap_ratios(const State& state, const std::vector<Pair>& contacts) {
    const std::vector<double>& radius = state.particles.radius;
    std::vector<double> ratios;
    if (!state.bonds && state.necks) {
        ratios = physics::recorded_contacts(state).overlap;
        for (std::size_t row = 0; row < ratios.size(); ++row)
            ratios[row] /= radius[static_cast<std::size_t>(contacts[row].i)] + radius[static_cast<std::size_t>(contacts[row].j)];
        return ratios;
    }
    for (const Pair& pair : contacts) {
        const double reach = radius[static_cast<std::size_t>(pair.i)] + radius[static_cast<std::size_t>(pair.j)];
        ratios.push_back(std::max(0.0, 1.0 - pair_vector(state.box, state.particles.position, pair).norm() / reach));
    }
    return ratios;
}

physics::GrainSize grain_size(const State& state) {
    const std::vector<double>& radius = state.particles.radius;
    if (!state.bonds) {
        const physics::RecordedContacts contacts = physics::recorded_contacts(state);
        return physics::grain_size(radius, contacts.pairs, contacts.overlap);
    }
    std::vector<double> overlap;
    for (std::size_t bond = 0; bond < state.bonds->size(); ++bond) {
        const auto [i, j] = state.bonds->pair[bond];
        const double reduced = physics::reduced_radius(radius[static_cast<std::size_t>(i)], radius[static_cast<std::size_t>(j)]);
        overlap.push_back(physics::overlap_of_neck(state.bonds->radius[bond], reduced));
    }
    return physics::grain_size(radius, contacts_of(state), overlap);
}

std::vector<std::size_t> cluster_sizes(std::size_t particles, const std::vector<Pair>& contacts) {
    Clusters clusters(particles);
    for (const Pair& pair : contacts) clusters.join(pair.i, pair.j);
    std::vector<std::size_t> members(particles);
    for (std::int32_t row = 0; row < static_cast<std::int32_t>(particles); ++row)
        ++members[static_cast<std::size_t>(clusters.root(row))];
    std::erase(members, 0);
    std::ranges::sort(members, std::greater());
    return members;
}

Eigen::Matrix3d fabric_tensor(const State& state, const std::vector<Pair>& contacts) {
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (const Pair& pair : contacts) {
        const Vec3 direction = pair_vector(state.box, state.particles.position, pair).normalized();
        sum += direction * direction.transpose();
    }
    return contacts.empty() ? sum : sum / static_cast<double>(contacts.size());
}

double mean_diameter(const Particles& particles) {
    const std::vector<double>& radius = particles.radius;
    return radius.empty() ? 0.0 : 2.0 * std::accumulate(radius.begin(), radius.end(), 0.0) / static_cast<double>(radius.size());
}

namespace {

/// Solid and volume of the region inside a body with free faces; no value if it has none.
Density inner_density(const State& state) {
    const std::size_t count = state.particles.size();
    if (count == 0) return {std::nullopt, "none"};
    const double diameter = mean_diameter(state.particles);
    Vec3 lower = state.particles.position.front(), upper = lower;
    for (const Vec3& position : state.particles.position) {
        lower = lower.cwiseMin(position);
        upper = upper.cwiseMax(position);
    }
    double volume = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
        const bool is_periodic = state.box.periodic[static_cast<std::size_t>(axis)];
        const double width = is_periodic ? state.box.lengths[axis] : upper[axis] - lower[axis] - 2.0 * diameter;
        if (!is_periodic && width < min_width * diameter) return {std::nullopt, "none"};
        volume *= width;
        if (is_periodic) continue;
        lower[axis] += diameter;
        upper[axis] -= diameter;
    }
    const std::vector<double> solids = solid_volumes(state);
    double solid = 0.0;
    for (std::size_t row = 0; row < count; ++row) {
        const Vec3& position = state.particles.position[row];
        bool inside = true;  // along a periodic axis a particle may lie outside the box and is inside the body all the same
        for (int axis = 0; axis < 3; ++axis)
            inside = inside && (state.box.periodic[static_cast<std::size_t>(axis)] ||
                                (position[axis] >= lower[axis] && position[axis] <= upper[axis]));
        if (inside) solid += solids[row];
    }
    return {solid / volume, "inner"};
}

}  // namespace

Density measured_density(const State& state, Measure measure, double probe) {
    const std::array<bool, 3>& periodic = state.box.periodic;
    const bool all_periodic = periodic[0] && periodic[1] && periodic[2];
    if (measure == Measure::box || (measure == Measure::automatic && all_periodic)) return {relative_density(state), "box"};
    if (measure != Measure::envelope) return inner_density(state);
    if (all_periodic) throw Error("the state is periodic along all axes and has no outside; take --measure box");
    if (state.particles.size() == 0) return {std::nullopt, "none"};
    const double volume = envelope_volume(state, probe > 0.0 ? probe : mean_diameter(state.particles));
    return {relative_density(state) * state.box.volume() / volume, "envelope"};
}

}  // namespace kiln::analysis
