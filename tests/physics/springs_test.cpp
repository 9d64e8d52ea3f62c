// springs_test.cpp: the stiffness matrix kept as springs against the same matrix assembled, and the aggregates' matrix made of it.
#include "linalg/springs.h"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>

#include "linalg/spring_coarsening.h"
#include "mechanics/elastic_solver.h"
#include "tests/physics/assembled.h"
#include "tests/physics/bonded_lattice.h"

using namespace kiln;
using namespace kiln::linalg;
using namespace kiln::mechanics;

namespace {

/// Of more than one chunk of nodes; bonds differ by up to a million times.
BondNetwork rough_network(std::array<int, 3> cells, bool periodic) {
    BondNetwork network =
        bonded_body(
            test::make_lattice({.cells = cells, .neighbour = 1.25, .periodic = periodic, .jitter = 0.2, .random_radii = true}), {})
            .network;
    for (std::size_t bond = 0; bond < network.bonds(); bond += 5) {
        const double factor = std::pow(10.0, -static_cast<double>(bond % 7));
        physics::BondStiffness& k = network.stiffness[bond];
        k = {factor * k.normal, factor * k.shear, factor * k.torsion, factor * k.bending};
    }
    return network;
}

Vec6 rough_motion(std::size_t node, int field) {
    Vec6 motion;
    for (int k = 0; k < 6; ++k) motion[k] = std::sin(static_cast<double>(7 * node) + 3.0 * k + 1.7 * field);
    return motion;
}

const std::array<std::pair<std::array<int, 3>, bool>, 3> cases{{{{30, 9, 9}, false}, {{26, 9, 10}, true}, {{40, 1, 1}, true}}};

}  // namespace

TEST_CASE("products with springs are those with the assembled matrix, for one field and for three") {
    for (const auto& [cells, periodic] : cases) {
        CAPTURE(cells[0]);
        const BondNetwork network = rough_network(cells, periodic);
        Springs<double> springs(network.nodes(), springs_of(network));
        BlockMatrix matrix = test::stiffness_matrix(network);
        const std::size_t held = network.nodes() / 3;
        const Vec6 ground = 0.1 * matrix.block.front().diagonal();
        springs.hold(held, ground);
        Vector x(network.nodes()), y, expected;
        Batch<3> three(network.nodes()), load(network.nodes(), Values<double, 3>::Zero());
        Batch<3> rest;
        for (std::size_t node = 0; node < network.nodes(); ++node) {
            x[node] = rough_motion(node, 0);
            for (int field = 0; field < 3; ++field) three[node].col(field) = rough_motion(node, field);
            load[node].col(1).setConstant(1.0);
        }
        multiply(springs, x, y);
        multiply(matrix, x, expected);
        expected[held] += ground.cwiseProduct(x[held]);
        Vector difference = y;
        add(-1.0, expected, difference);
        CHECK(norm(difference) <= 1e-14 * norm(expected));
        residual<3>(springs, three, load, rest);
        for (int field = 0; field < 3; ++field) {
            for (std::size_t node = 0; node < network.nodes(); ++node) x[node] = three[node].col(field);
            multiply(springs, x, expected);
            double off = 0.0;
            for (std::size_t node = 0; node < network.nodes(); ++node)
                off = std::max(off, (load[node].col(field) - expected[node] - rest[node].col(field)).norm());
            CHECK(off <= 1e-14 * norm(expected));
        }
        double off = 0.0;
        const std::vector<Mat6> diagonal = diagonal_blocks(springs);
        for (std::int32_t row = 0; row < matrix.rows(); ++row)
            for (auto k = static_cast<std::size_t>(matrix.first(row)); k < static_cast<std::size_t>(matrix.last(row)); ++k)
                if (matrix.column[k] == row && static_cast<std::size_t>(row) != held)
                    off =
                        std::max(off, (matrix.block[k] - diagonal[static_cast<std::size_t>(row)]).norm() / matrix.block[k].norm());
        CHECK(off <= 1e-14);
    }
}

TEST_CASE("the widest registers of this processor give the same bytes as the narrowest") {
    const BondNetwork network = rough_network({30, 9, 9}, false);
    const Springs<double> springs(network.nodes(), springs_of(network));
    const auto check = [&]<typename Real, int width>() {
        const Springs<Real> rounded(springs, 1.0, [](const auto& spring) { return spring.first % 3 == 0; });
        std::vector<Freedoms<Real, width>> motions;
        for (std::size_t node = 0; node < network.nodes(); ++node) {
            Values<double, width> values;
            for (int field = 0; field < width; ++field) values.col(field) = rough_motion(node, field);
            motions.push_back(motion_of<Real, width>(values));
        }
        std::vector<Values<double, width>> forces[2];
        for (const bool wide : {false, has_wide_registers})
            for (std::size_t chunk = 0; chunk < rounded.chunks(); ++chunk)
                rounded.template for_forces<width>(
                    chunk, motions,
                    [&](std::size_t, const Freedoms<Real, width>& force) { forces[wide ? 1 : 0].push_back(values_of(force)); },
                    wide);
        if (!has_wide_registers) return;
        CHECK(forces[0].size() == network.nodes());
        CHECK(forces[0] == forces[1]);
    };
    check.operator()<float, 1>();
    check.operator()<float, 3>();
    check.operator()<double, 1>();
    check.operator()<double, 3>();
}

TEST_CASE("forces without idle springs are those of the network without them") {
    const BondNetwork network = rough_network({30, 9, 9}, true);
    const std::vector<Spring<double>> all = springs_of(network);
    const auto idle = [](const Spring<double>& spring) { return (spring.first + spring.second) % 3 == 0; };
    std::vector<Spring<double>> active;
    std::copy_if(all.begin(), all.end(), std::back_inserter(active), [&](const auto& spring) { return !idle(spring); });
    REQUIRE(active.size() < 0.8 * static_cast<double>(all.size()));
    const Springs<double> parted(Springs<double>(network.nodes(), all), 2.0, idle);
    Vector x(network.nodes()), without(network.nodes()), expected;
    for (std::size_t node = 0; node < network.nodes(); ++node) x[node] = rough_motion(node, 0);
    multiply(Springs<double>(network.nodes(), active), x, expected);
    for (std::size_t chunk = 0; chunk < parted.chunks(); ++chunk)
        parted.for_forces<1, Which::active>(
            chunk, x, [&](std::size_t node, const Freedoms<double, 1>& force) { without[node] = 0.5 * values_of(force); });
    CHECK(parted.chunks() > 1);
    for (std::size_t node = 0; node < network.nodes(); ++node) 
        CHECK((without[node] - expected[node]).norm() <= 1e-14 * norm(expected));
    multiply(parted, x, without);
    multiply(Springs<double>(network.nodes(), all), x, expected);
    for (std::size_t node = 0; node < network.nodes(); ++node)
        CHECK((0.5 * without[node] - expected[node]).norm() <= 1e-14 * norm(expected));
}

TEST_CASE("springs that are softened are those of the softer network") {
    BondNetwork network = rough_network({30, 9, 9}, false);
    Springs<double> springs(network.nodes(), springs_of(network));
    for (std::size_t bond = 3; bond < network.bonds(); bond += 11) {
        const double share = bond % 2 == 0 ? 0.25 : 1e-6;
        springs.soften(bond, share);
        physics::BondStiffness& k = network.stiffness[bond];
        k = {share * k.normal, share * k.shear, share * k.torsion, share * k.bending};
    }
    Vector x(network.nodes()), y, expected;
    for (std::size_t node = 0; node < network.nodes(); ++node) x[node] = rough_motion(node, 1);
    multiply(springs, x, y);
    multiply(Springs<double>(network.nodes(), springs_of(network)), x, expected);
    add(-1.0, expected, y);
    CHECK(norm(y) <= 1e-14 * norm(expected));
}

TEST_CASE("the matrix of the aggregates, made chunk by chunk, is P^T A P") {
    for (const auto& [cells, periodic] : {cases[0], cases[1]}) {
        const BondNetwork network = rough_network(cells, periodic);
        Springs<double> springs(network.nodes(), springs_of(network));
        BlockMatrix matrix = test::stiffness_matrix(network);
        const Vec6 ground = 0.1 * matrix.block.front().diagonal();
        springs.hold(0, ground);
        for (std::int64_t k = matrix.first(0); k < matrix.last(0); ++k)
            if (matrix.column[static_cast<std::size_t>(k)] == 0) matrix.block[static_cast<std::size_t>(k)].diagonal() += ground;
        NodeGeometry geometry{network.position, network.period / network.rotation_length};
        for (Vec3& position : geometry.position) position /= network.rotation_length;
        const Aggregates aggregates = find_aggregates(couplings_of(springs), 2);
        CHECK(aggregates.root.size() < network.nodes() / 8);
        std::vector<Mat6> inverse = diagonal_blocks(springs);
        for (Mat6& block : inverse) block = block.inverse().eval();
        const double damping = 0.6;
        const BlockMatrix coarse = coarse_matrix(springs, inverse, damping, aggregates, arms_of(aggregates, geometry));
        BlockMatrix damped;  // I - damping D^-1 A
        damped = matrix;
        for (std::int32_t row = 0; row < matrix.rows(); ++row)
            for (auto k = static_cast<std::size_t>(matrix.first(row)); k < static_cast<std::size_t>(matrix.last(row)); ++k) {
                damped.block[k] = -damping * inverse[static_cast<std::size_t>(row)] * matrix.block[k];
                if (matrix.column[k] == row) damped.block[k] += Mat6::Identity();
            }
        const BlockMatrix prolongation = product(damped, rigid_prolongation(aggregates, geometry));
        const BlockMatrix expected = transposed_product(prolongation, column_index(prolongation), product(matrix, prolongation));
        REQUIRE(coarse.rows() == expected.rows());
        CHECK(coarse.rows() == coarse.columns);
        double off = 0.0, size = 0.0;
        for (std::int32_t row = 0; row < expected.rows(); ++row) {
            std::vector<Mat6> difference(static_cast<std::size_t>(expected.columns), Mat6::Zero());
            for (auto k = static_cast<std::size_t>(expected.first(row)); k < static_cast<std::size_t>(expected.last(row)); ++k) {
                difference[static_cast<std::size_t>(expected.column[k])] += expected.block[k];
                size += expected.block[k].squaredNorm();
            }
            for (auto k = static_cast<std::size_t>(coarse.first(row)); k < static_cast<std::size_t>(coarse.last(row)); ++k)
                difference[static_cast<std::size_t>(coarse.column[k])] -= coarse.block[k];
            for (const Mat6& block : difference) off += block.squaredNorm();
        }
        CHECK(std::sqrt(off / size) < 1e-13);
    }
}
