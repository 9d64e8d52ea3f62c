// state.cpp: sums over a state and row selection.
#include "core/state.h"

#include <numbers>
#include <numeric>

namespace kiln {

namespace {

template <typename Value>
std::vector<Value> pick(const std::vector<Value>& source, const std::vector<std::int32_t>& rows) {
    std::vector<Value> picked;
    picked.reserve(rows.size());
    for (const std::int32_t row : rows) picked.push_back(source[static_cast<std::size_t>(row)]);
    return picked;
}

std::vector<NamedArray> pick(const std::vector<NamedArray>& arrays, const std::vector<std::int32_t>& rows) {
    std::vector<NamedArray> picked;
    picked.reserve(arrays.size());
    for (const NamedArray& named : arrays) picked.push_back({named.name, take_rows(named.array, rows)});
    return picked;
}

}  // namespace

double particle_volume(const Particles& particles) {
    double cubes = 0.0;
    for (const double radius : particles.radius) cubes += radius * radius * radius;
    return 4.0 / 3.0 * std::numbers::pi * cubes;
}

double relative_density(const State& state) {
    double solid = particle_volume(state.particles);
    if (state.bonds) solid += std::accumulate(state.bonds->volume.begin(), state.bonds->volume.end(), 0.0);
    return solid / state.box.volume();
}

Vec3 bond_vector(const State& state, const Bonds& bonds, std::size_t bond) {
    const auto [first, second] = bonds.pair[bond];
    return state.particles.position[static_cast<std::size_t>(second)] + state.box.shift(bonds.image[bond]) -
           state.particles.position[static_cast<std::size_t>(first)];
}

Particles take_rows(const Particles& particles, const std::vector<std::int32_t>& rows) {
    return {pick(particles.id, rows), pick(particles.position, rows), pick(particles.radius, rows),
            pick(particles.material, rows), pick(particles.other, rows)};
}

Bonds take_rows(const Bonds& bonds, const std::vector<std::int32_t>& rows) {
    return {pick(bonds.pair, rows),   pick(bonds.image, rows),  pick(bonds.radius, rows),
            pick(bonds.length, rows), pick(bonds.volume, rows), pick(bonds.other, rows)};
}

}  // namespace kiln
