// bonded_lattice.h: bonded lattices, regular and disturbed, for the mechanics tests.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "core/neighbours.h"
#include "core/state.h"
#include "physics/materials.h"

namespace kiln::test {

struct Lattice {
    std::array<int, 3> cells{1, 1, 1};
    std::vector<Vec3> basis{Vec3(0.5, 0.5, 0.5)};  // in units of the cell's edge
    double edge = 1e-7;                            // m
    double neighbour = 1.0;                        // bonds join centres at most that many edges (and 1 %) apart
    bool periodic = true;
    double jitter = 0.0;        // of each coordinate, in edges
    bool random_radii = false;  // of bonds, from thin to thick
};

/// Alumina spheres with bonds between neighbours.
inline State make_lattice(const Lattice& lattice) {
    State state;
    state.materials.push_back(physics::builtin_material("alumina"));
    state.box.periodic.fill(lattice.periodic);
    std::mt19937 random(7);
    const auto uniform = [&](double low, double high) { return low + (high - low) * static_cast<double>(random()) / 4294967296.0; };
    for (int axis = 0; axis < 3; ++axis) state.box.lengths[axis] = lattice.cells[static_cast<std::size_t>(axis)] * lattice.edge;
    const double radius = 0.45 * lattice.neighbour * lattice.edge;
    for (int x = 0; x < lattice.cells[0]; ++x)
        for (int y = 0; y < lattice.cells[1]; ++y)
            for (int z = 0; z < lattice.cells[2]; ++z)
                for (const Vec3& site : lattice.basis) {
                    Vec3 position = lattice.edge * (Vec3(x, y, z) + site);
                    for (double& coordinate : position) coordinate += lattice.edge * uniform(-lattice.jitter, lattice.jitter);
                    state.particles.position.push_back(position);
                }
    const std::size_t count = state.particles.position.size();
    state.particles.radius.assign(count, radius);
    state.particles.material.assign(count, 0);
    for (std::size_t i = 0; i < count; ++i) state.particles.id.push_back(static_cast<std::int64_t>(i));
    Bonds bonds;
    const std::vector<double> reach(count, 0.505 * lattice.neighbour * lattice.edge);
    for (const Pair& pair : find_pairs(state.box, state.particles.position, reach)) {
        const double distance = pair_vector(state.box, state.particles.position, pair).norm();
        const double bond_radius = lattice.random_radii ? radius * uniform(0.1, 0.98) : 0.5 * radius;
        bonds.pair.push_back({pair.i, pair.j});
        bonds.image.push_back(pair.image);
        bonds.radius.push_back(bond_radius);
        bonds.length.push_back(std::max(0.0, distance - 2.0 * std::sqrt(radius * radius - bond_radius * bond_radius)));
        bonds.volume.push_back(std::numbers::pi * bond_radius * bond_radius * bonds.length.back());
    }
    state.bonds = std::move(bonds);
    return state;
}

/// Moves particles to other images of the box, and the bonds with them: the same periodic body.
inline void scatter_images(State& state) {
    const auto shift = [](std::int32_t particle) {
        return Image{static_cast<std::int8_t>(particle % 3 - 1), static_cast<std::int8_t>(particle % 5 - 2), 0};
    };
    for (std::size_t i = 0; i < state.particles.size(); ++i) {
        state.particles.position[i] += state.box.shift(shift(static_cast<std::int32_t>(i)));
    }
    for (std::size_t bond = 0; bond < state.bonds->size(); ++bond) {
        const Image first = shift(state.bonds->pair[bond][0]), second = shift(state.bonds->pair[bond][1]);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            state.bonds->image[bond][axis] = static_cast<std::int8_t>(state.bonds->image[bond][axis] + first[axis] - second[axis]);
        }
    }
}

/// A simple cubic lattice without order: positions and bond radii at random, neighbours up to 1.25 edges.
inline State make_rough_bar(std::array<int, 3> cells, double edge = 1e-7) {
    return make_lattice({.cells = cells, .edge = edge, .neighbour = 1.25, .jitter = 0.2, .random_radii = true});
}

/// A bar of 3 x 4 particles across without upright bonds in its middle slice, where particles stand `gap` diameters apart.
inline State make_cracked_bar(int length, double gap, std::size_t& removed) {
    State state = make_lattice({.cells = {length, 3, 4}});
    for (double& radius : state.particles.radius) radius = 0.5e-7 * (1.0 - gap);
    std::vector<std::int32_t> kept;
    for (std::size_t bond = 0; bond < state.bonds->size(); ++bond) {
        const auto [i, j] = state.bonds->pair[bond];
        if (i / 12 != length / 2 || std::abs(i - j) != 1) kept.push_back(static_cast<std::int32_t>(bond));
    }
    removed = state.bonds->size() - kept.size();
    state.bonds = take_rows(*state.bonds, kept);
    return state;
}

}  // namespace kiln::test
