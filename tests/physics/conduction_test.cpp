// conduction_test.cpp: conduction through necks: half-spaces, slabs, chains and lattices, what bounds it, and its network.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "core/neighbours.h"
#include "mechanics/conduction.h"
#include "physics/conduction.h"
#include "tests/physics/bonded_lattice.h"
#include "tests/physics/relative.h"

using namespace kiln;
using kiln::test::relative;
using mechanics::conductivity;
using std::numbers::pi;

namespace {

constexpr double k = 30.0;  // W/(m K)

/// Overlapping unit spheres that meet in circles of radius x, periodic, and the fraction that their union fills.
struct Overlapping {
    State state;
    double fraction;
};

Overlapping overlapping(const std::vector<Vec3>& basis, double edge_over_distance, int contacts, double x, int cells = 3) {
    const double distance = 2.0 * std::sqrt(1.0 - x * x), edge = edge_over_distance * distance;
    State state = test::make_lattice(
        {.cells = {cells, cells, cells}, .basis = basis, .edge = edge, .neighbour = 1.0 / edge_over_distance});
    state.particles.radius.assign(state.particles.size(), 1.0);
    state.bonds->radius.assign(state.bonds->size(), x);
    state.bonds->length.assign(state.bonds->size(), 0.0);
    const double height = 1.0 - distance / 2.0;
    const double volume = sphere_volume(1.0) - contacts * pi * height * height * (1.0 - height / 3.0);
    const double fraction = static_cast<double>(state.particles.size()) * volume / state.box.volume();
    REQUIRE(2 * state.bonds->size() == static_cast<std::size_t>(contacts) * state.particles.size());
    return {std::move(state), fraction};
}

const std::vector<Vec3> sc{Vec3(0, 0, 0)}, bcc{Vec3(0, 0, 0), Vec3(0.5, 0.5, 0.5)},
    fcc{Vec3(0, 0, 0), Vec3(0.5, 0.5, 0), Vec3(0.5, 0, 0.5), Vec3(0, 0.5, 0.5)};

}  // namespace

TEST_CASE("conduction: early necks are Maxwell's slots in half-spaces, full ones slabs") {
    const double R = 50e-9, a = 1e-4 * R;
    const physics::NeckSide early = physics::neck_side(k, R, a, 0.0);
    CHECK(early.constriction == relative(1.0 / (4.0 * k * a), 1e-3));
    CHECK(early.length == relative(R, 1e-6));
    for (const double radius : {R, 1.5 * R}) {
        const physics::NeckSide full = physics::neck_side(k, R, radius, 2.0 * R);
        CHECK(full.length == relative(R, 1e-12));
        CHECK(full.constriction == relative(1e-3 / (k * pi * R), 1e-9));  // a slab is uniform: only the least is left
    }
}

TEST_CASE("conduction: what a neck constricts is positive, finite, and falls as the neck grows, for any size of its sphere") {
    for (const double R : {1.0, 3.0, 100.0}) {
        double before = HUGE_VAL;
        for (const double a : {1e-9, 1e-6, 1e-3, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99}) {
            const physics::NeckSide side = physics::neck_side(k, R, a, 0.0);
            CHECK(side.constriction > 0.0);
            CHECK(side.constriction < before);
            before = side.constriction;
        }
        CHECK(physics::neck_side(k, R, 1.0, 0.0).constriction > 0.0);
    }
    CHECK(physics::bulk_resistance(k, 1.0, 2.0, 0.3) == physics::bulk_resistance(k, 1.0, 2.0, 1.0));
    CHECK(physics::bulk_resistance(k, 1.0, 2.0, 2.0) == relative(std::pow(2.0, 0.75) * 0.94 / k, 1e-12));
}

TEST_CASE("conduction: cubic lattices of overlapping spheres within 4 % of voxel solutions, and below the bound") {
    struct Row {
        const std::vector<Vec3>& basis;
        double edge;
        int contacts;
        double x, found;  // voxel solution over k, 3 %
    };
    const Row rows[] = {{sc, 1.0, 6, 0.3, 0.285},
                        {sc, 1.0, 6, 0.5, 0.556},
                        {sc, 1.0, 6, 0.7, 0.931},
                        {bcc, 2.0 / std::sqrt(3.0), 8, 0.2, 0.300},
                        {bcc, 2.0 / std::sqrt(3.0), 8, 0.3, 0.459},
                        {bcc, 2.0 / std::sqrt(3.0), 8, 0.4, 0.632},
                        {bcc, 2.0 / std::sqrt(3.0), 8, 0.5, 0.831},
                        {fcc, std::sqrt(2.0), 12, 0.2, 0.445},
                        {fcc, std::sqrt(2.0), 12, 0.3, 0.616},
                        {fcc, std::sqrt(2.0), 12, 0.4, 0.792}};
    for (const Row& row : rows) {
        const Overlapping lattice = overlapping(row.basis, row.edge, row.contacts, row.x);
        const mechanics::Conductivity found = conductivity(lattice.state, lattice.fraction, {k, 0.0}, 1e-10);
        CAPTURE(row.contacts);
        CAPTURE(row.x);
        CHECK(found.converged);
        CHECK_FALSE(found.at_bound);
        CHECK(found.tensor.trace() / 3.0 == relative(k * row.found, 0.04));
        CHECK(found.tensor.trace() / 3.0 < found.bound);
        CHECK(found.bound == relative(k * 2.0 * lattice.fraction / (3.0 - lattice.fraction), 1e-14));
        CHECK((found.tensor - found.tensor.trace() / 3.0 * Eigen::Matrix3d::Identity()).norm() < 1e-6 * found.tensor.norm());
    }
}

TEST_CASE("conduction: one particle in its box, by hand, with the grain boundary in series") {
    for (const double boundary : {0.0, 1e-3, 1e3}) {
        const Overlapping cell = overlapping(sc, 1.0, 6, 0.4, 1);
        const double distance = 2.0 * std::sqrt(0.84), volume = cell.fraction * cell.state.box.volume();
        const physics::NeckSide side = physics::neck_side(k, 1.0, 0.4, 0.0);
        const double resistance = 2.0 * (side.constriction + physics::bulk_resistance(k, side.length, volume, 1.0)) +
                                  boundary / (pi * 0.16);
        const mechanics::Conductivity found = conductivity(cell.state, cell.fraction, {k, boundary}, 1e-10);
        for (int axis = 0; axis < 3; ++axis) CHECK(found.tensor(axis, axis) == relative(1.0 / (resistance * distance), 1e-12));
        CHECK(found.coordination_number == 6.0);
    }
}

TEST_CASE("conduction: a rough lattice in balance: symmetric, the same in any unit, at any place, and never above straight flow") {
    const auto rough = [](double edge) {
        return test::make_lattice({.cells = {6, 6, 6}, .edge = edge, .neighbour = 1.25, .jitter = 0.2, .random_radii = true});
    };
    const State state = rough(1e-7);
    const double fraction = relative_density(state);
    const mechanics::Conductivity found = conductivity(state, fraction, {k, 1e-9}, 1e-11);
    CHECK(found.converged);
    CHECK(found.residual <= 1e-11);
    CHECK((found.tensor - found.tensor.transpose()).norm() < 1e-12 * found.tensor.norm());
    State moved = state;
    test::scatter_images(moved);
    CHECK((conductivity(moved, fraction, {k, 1e-9}, 1e-11).tensor - found.tensor).norm() < 1e-9 * found.tensor.norm());
    CHECK((conductivity(rough(1.0), fraction, {k, 1e-2}, 1e-11).tensor - found.tensor).norm() < 1e-9 * found.tensor.norm());
    CHECK((conductivity(state, fraction, {2.0 * k, 0.5e-9}, 1e-11).tensor - 2.0 * found.tensor).norm() <
          1e-9 * found.tensor.norm());
    CHECK(found.tensor.trace() / 3.0 < found.bound);
}

TEST_CASE("conduction: where the network would exceed the bound it is held there, and it says so") {
    const Overlapping dense = overlapping(fcc, std::sqrt(2.0), 12, 0.49);
    const mechanics::Conductivity found = conductivity(dense.state, dense.fraction, {k, 0.0}, 1e-10);
    CHECK(found.at_bound);
    CHECK(found.tensor.trace() / 3.0 == relative(found.bound, 1e-12));
}

TEST_CASE("conduction: a free axis, bonds that lead nowhere, a stop") {
    State free = test::make_lattice({.cells = {4, 4, 4}});
    free.box.periodic[2] = false;
    CHECK_THROWS_WITH_AS(conductivity(free, 0.5, {k, 0.0}, 1e-8), doctest::Contains("not periodic along all axes"), Error);
    State layers = test::make_lattice({.cells = {4, 4, 4}});
    std::vector<std::int32_t> kept;
    for (std::size_t bond = 0; bond < layers.bonds->size(); ++bond)
        if (std::abs(bond_vector(layers, *layers.bonds, bond)[2]) < 1e-9) kept.push_back(static_cast<std::int32_t>(bond));
    layers.bonds = take_rows(*layers.bonds, kept);
    CHECK_THROWS_WITH_AS(conductivity(layers, 0.5, {k, 0.0}, 1e-8), doctest::Contains("do not reach through the box"), Error);
    const State rough = test::make_lattice({.cells = {5, 5, 5}, .neighbour = 1.25, .jitter = 0.2, .random_radii = true});
    CHECK_THROWS_AS(conductivity(rough, 0.5, {k, 0.0}, 1e-8, [] { return true; }), Interrupted);
}
