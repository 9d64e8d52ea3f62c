// clusters_test.cpp: what hangs together: clusters, also through periodic faces, pieces of bonded bodies, and their texture.
#include <doctest/doctest.h>

#include <algorithm>
#include <numeric>

#include "analysis/structure.h"
#include "core/contacts.h"
#include "mechanics/connectivity.h"
#include "tests/physics/relative.h"

using namespace kiln;
using kiln::test::relative;

namespace {

/// A chain along an axis of a periodic box, closed through its faces or open.
std::vector<Pair> chain(std::int32_t rows, std::size_t axis, bool closed) {
    std::vector<Pair> pairs;
    for (std::int32_t row = 0; row + 1 < rows; ++row) pairs.push_back({row, row + 1, {0, 0, 0}});
    if (closed) {
        pairs.push_back({0, rows - 1, {0, 0, 0}});
        pairs.back().image[axis] = -1;
    }
    return pairs;
}

/// Simple cubic lattice of spheres that touch where radius is half the edge (m), in a periodic box of n cells a side.
State cubic(int n, double edge, double radius) {
    State state;
    state.box.lengths = Vec3::Constant(n * edge);
    for (int x = 0; x < n; ++x)
        for (int y = 0; y < n; ++y)
            for (int z = 0; z < n; ++z) state.particles.position.push_back(edge * Vec3(x + 0.25, y + 0.5, z + 0.75));
    const std::size_t count = state.particles.position.size();
    state.particles.radius.assign(count, radius);
    state.particles.material.assign(count, 0);
    state.particles.id.resize(count);
    std::iota(state.particles.id.begin(), state.particles.id.end(), 0);
    return state;
}

}  // namespace

TEST_CASE("clusters: the lowest row stands for its cluster, whatever the order in which rows are joined") {
    const std::vector<std::array<std::int32_t, 2>> joins{{5, 3}, {1, 7}, {3, 9}, {7, 2}, {9, 5}};
    std::vector<std::size_t> order{0, 1, 2, 3, 4};
    do {
        Clusters clusters(10);
        for (const std::size_t k : order) clusters.join(joins[k][0], joins[k][1]);
        const std::vector<std::int32_t> wanted{0, 1, 1, 3, 4, 3, 6, 1, 8, 3};
        for (std::int32_t row = 0; row < 10; ++row) CHECK(clusters.root(row) == wanted[static_cast<std::size_t>(row)]);
    } while (std::next_permutation(order.begin(), order.end()));
}

TEST_CASE("clusters: a chain percolates along its axis if it is closed, and not if one contact is missing") {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        std::array<bool, 3> wanted{false, false, false};
        CHECK(percolating_axes(6, chain(6, axis, false)) == wanted);
        wanted[axis] = true;
        CHECK(percolating_axes(6, chain(6, axis, true)) == wanted);
    }
    const std::vector<Pair> own_image{{2, 2, {0, 1, 0}}};
    CHECK(percolating_axes(3, own_image) == std::array<bool, 3>{false, true, false});
    // Through a face and back again: the cluster does not reach its image.
    const std::vector<Pair> back{{0, 1, {1, 0, 0}}, {1, 2, {-1, 0, 0}}, {0, 2, {0, 0, 0}}};
    CHECK(percolating_axes(3, back) == std::array<bool, 3>{false, false, false});
}

TEST_CASE("clusters: images along a cluster add up over joins in any order") {
    // Rows 0 to 3 wind once around x and twice around z.
    std::vector<Pair> pairs{{0, 1, {1, 0, 0}}, {1, 2, {0, 0, 1}}, {2, 3, {0, 0, 1}}};
    std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.i < b.i; });
    do {
        PeriodicClusters clusters(4);
        for (const Pair& pair : pairs) clusters.join(pair);
        PeriodicClusters::Offset first{}, last{};
        CHECK(clusters.root(0, first) == clusters.root(3, last));
        CHECK(std::array{last[0] - first[0], last[1] - first[1], last[2] - first[2]} == std::array{1, 0, 2});
        CHECK(clusters.percolating() == std::array<bool, 3>{false, false, false});
        clusters.join({0, 3, {1, 0, 2}});
        CHECK(clusters.percolating() == std::array<bool, 3>{false, false, false});
        clusters.join({0, 3, {1, 0, 1}});
        CHECK(clusters.percolating() == std::array<bool, 3>{false, false, true});
    } while (std::next_permutation(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.i < b.i; }));
}

TEST_CASE("connectivity: pieces stand breadth first from their first particle in the order given") {
    // 0-1-2-3 with a branch 1-4; 5-6; 7 alone, with a bond to its own image.
    const std::vector<std::array<std::int32_t, 2>> bonds{{0, 1}, {1, 2}, {5, 6}, {2, 3}, {1, 4}, {7, 7}};
    const std::vector<std::int32_t> order{6, 3, 0, 1, 2, 4, 5, 7};
    const mechanics::Components pieces = mechanics::find_components(order, bonds);
    CHECK(pieces.particle == std::vector<std::int32_t>{6, 5, 3, 2, 1, 0, 4, 7});
    CHECK(pieces.start == std::vector<std::size_t>{0, 2, 7, 8});
    CHECK(pieces.largest() == 1);
    const Grouping<std::int32_t> incidence = mechanics::find_incidence(8, bonds);
    CHECK(incidence.begin == std::vector<std::size_t>{0, 1, 4, 6, 7, 8, 9, 10, 11});
    CHECK(incidence.items == std::vector<std::int32_t>{0, 0, 1, 4, 1, 3, 3, 4, 2, 2, 5});
}

TEST_CASE("connectivity: of pieces of one size the first is the largest, and no particles are no pieces") {
    const std::vector<std::array<std::int32_t, 2>> bonds{{0, 2}, {1, 3}};
    const std::vector<std::int32_t> order{1, 0, 2, 3};
    CHECK(mechanics::find_components(order, bonds).largest() == 0);
    CHECK(mechanics::find_components({}, {}).size() == 0);
}

TEST_CASE("structure: a simple cubic lattice has six contacts a particle, no texture and one cluster") {
    const State state = cubic(4, 1e-7, 0.51e-7);
    const std::vector<Pair> contacts = analysis::contacts_of(state);
    CHECK(contacts.size() == 3 * 64);
    for (const double ratio : analysis::overlap_ratios(state, contacts)) CHECK(ratio == relative(0.02 / 1.02, 1e-12));
    CHECK((analysis::fabric_tensor(state, contacts) - Eigen::Matrix3d::Identity() / 3.0).norm() < 1e-14);
    CHECK(analysis::cluster_sizes(64, contacts) == std::vector<std::size_t>{64});
    const ContactStatistics statistics = contact_statistics(state.box, state.particles, contacts);
    CHECK(statistics.coordination_number == 6.0);
    CHECK(statistics.mean_overlap_ratio == relative(0.02 / 1.02, 1e-12));
    CHECK(percolating_axes(64, contacts) == std::array<bool, 3>{true, true, true});
}

TEST_CASE("structure: rows of touching spheres are clusters of their own with the texture of their direction") {
    State state = cubic(4, 1e-7, 0.51e-7);
    for (Vec3& position : state.particles.position) position[2] *= 2.0, position[0] *= 2.0;
    state.box.lengths[2] *= 2.0, state.box.lengths[0] *= 2.0;
    std::vector<Pair> contacts = analysis::contacts_of(state);
    CHECK(contacts.size() == 64);
    Eigen::Matrix3d along_y = Eigen::Matrix3d::Zero();
    along_y(1, 1) = 1.0;
    CHECK((analysis::fabric_tensor(state, contacts) - along_y).norm() < 1e-14);
    CHECK(analysis::cluster_sizes(64, contacts) == std::vector<std::size_t>(16, 4));
    CHECK(percolating_axes(64, contacts) == std::array<bool, 3>{false, true, false});
    CHECK(analysis::cluster_sizes(3, {}) == std::vector<std::size_t>(3, 1));
    CHECK(analysis::fabric_tensor(state, {}).isZero(0.0));
}

TEST_CASE("structure: the inner density of a lattice with free faces is that of the layers inside, bonds by halves") {
    State state = cubic(9, 1e-7, 0.4e-7);
    state.box.periodic = {true, true, false};
    const double ball = 4.0 / 3.0 * std::numbers::pi * 0.064e-21;
    // From the second layer's centre less 0.2 edges to the last but one: between the outermost centres 8 edges, less 0.8 a side.
    const analysis::Density density = analysis::measured_density(state);
    CHECK(density.measure == "inner");
    CHECK(*density.value == relative(7.0 * 81.0 * ball / (81e-14 * 6.4e-7), 1e-12));
    // A bond along z at every particle but the last layer's, of a tenth of a ball: each layer inside has half of two.
    state.bonds.emplace();
    for (std::int32_t row = 0; row < 729; ++row) {
        if (row % 9 == 8) continue;
        state.bonds->pair.push_back({row, row + 1});
        state.bonds->image.push_back({0, 0, 0});
        state.bonds->radius.push_back(1e-8);
        state.bonds->length.push_back(2e-8);
        state.bonds->volume.push_back(0.1 * ball);
    }
    CHECK(*analysis::measured_density(state).value == relative(7.0 * 81.0 * 1.1 * ball / (81e-14 * 6.4e-7), 1e-12));
    const analysis::Density whole = analysis::measured_density(state, analysis::Measure::box);
    CHECK(whole.measure == "box");
    CHECK(*whole.value == relative((729.0 + 64.8) * ball / 729e-21, 1e-12));
}

TEST_CASE("structure: a body less than five diameters high has no inside") {
    State state = cubic(5, 1e-7, 0.5e-7);
    state.box.periodic = {true, true, false};
    CHECK(analysis::measured_density(state).measure == "none");
    CHECK_FALSE(analysis::measured_density(state).value.has_value());
    state.box.periodic = {true, true, true};
    CHECK_THROWS_WITH_AS(analysis::measured_density(state, analysis::Measure::envelope), doctest::Contains("no outside"), Error);
}
