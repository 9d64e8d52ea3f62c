// structure.cpp: contacts, clusters and density of a state.
#include "tools/analyze/structure.h"

#include <algorithm>
#include <numbers>
#include <numeric>

namespace kiln::analyze {

namespace {

constexpr double least_width = 3.0;  // of the inner region, in mean diameters

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
    if (!state.bonds) return find_pairs(state.box, state.particles.position, state.particles.radius);
    std::vector<Pair> contacts;
    for (std::size_t bond = 0; bond < state.bonds->size(); ++bond)
        contacts.push_back({state.bonds->pair[bond][0], state.bonds->pair[bond][1], state.bonds->image[bond]});
    return contacts;
}

double mean_overlap_ratio(const State& state, const std::vector<Pair>& contacts) {
    const std::vector<double>& radius = state.particles.radius;
    double sum = 0.0;
    for (const Pair& pair : contacts) {
        const double reach = radius[static_cast<std::size_t>(pair.i)] + radius[static_cast<std::size_t>(pair.j)];
        sum += std::max(0.0, 1.0 - pair_vector(state.box, state.particles.position, pair).norm() / reach);
    }
    return contacts.empty() ? 0.0 : sum / static_cast<double>(contacts.size());
}

double largest_cluster_fraction(std::size_t particles, const std::vector<Pair>& contacts) {
    if (particles == 0) return 0.0;
    Clusters clusters(particles);
    for (const Pair& pair : contacts) clusters.join(pair.i, pair.j);
    std::vector<std::size_t> members(particles);
    for (std::int32_t row = 0; row < static_cast<std::int32_t>(particles); ++row) ++members[static_cast<std::size_t>(clusters.root(row))];
    return static_cast<double>(std::ranges::max(members)) / static_cast<double>(particles);
}

Density measured_density(const State& state) {
    const std::array<bool, 3>& periodic = state.box.periodic;
    if (periodic[0] && periodic[1] && periodic[2]) return {relative_density(state), "box"};
    const std::size_t count = state.particles.size();
    if (count == 0) return {std::nullopt, "none"};
    const std::vector<double>& radius = state.particles.radius;
    const double diameter = 2.0 * std::accumulate(radius.begin(), radius.end(), 0.0) / static_cast<double>(count);

    Vec3 lower = state.particles.position.front(), upper = lower;
    for (const Vec3& position : state.particles.position) {
        lower = lower.cwiseMin(position);
        upper = upper.cwiseMax(position);
    }
    double volume = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
        const bool is_periodic = periodic[static_cast<std::size_t>(axis)];
        const double width = is_periodic ? state.box.lengths[axis] : upper[axis] - lower[axis] - 2.0 * diameter;
        if (!is_periodic && width < least_width * diameter) return {std::nullopt, "none"};
        volume *= width;
        if (is_periodic) continue;
        lower[axis] += diameter;
        upper[axis] -= diameter;
    }
    const std::vector<double> solids = solid_volumes(state);
    double solid = 0.0;
    for (std::size_t row = 0; row < count; ++row) {
        const Vec3& position = state.particles.position[row];
        if ((position.array() >= lower.array()).all() && (position.array() <= upper.array()).all()) solid += solids[row];
    }
    return {solid / volume, "inner"};
}

}  // namespace kiln::analyze
