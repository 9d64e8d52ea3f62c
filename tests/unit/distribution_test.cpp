// distribution_test.cpp: histograms, and pair correlations of lattices whose shells are known.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "analysis/histogram.h"
#include "analysis/pair_correlation.h"
#include "tests/physics/relative.h"

using namespace kiln;
using kiln::test::relative;

namespace {

/// Points in a periodic box of n cells with an edge (m) and the given places in a cell, all moved by a shift (m).
State lattice(int n, double edge, const std::vector<Vec3>& cell, const Vec3& shift) {
    State state;
    state.box.lengths = Vec3::Constant(n * edge);
    for (int x = 0; x < n; ++x)
        for (int y = 0; y < n; ++y)
            for (int z = 0; z < n; ++z)
                for (const Vec3& place : cell) state.particles.position.push_back(shift + edge * (Vec3(x, y, z) + place));
    state.particles.radius.assign(state.particles.position.size(), 0.5 * edge);
    return state;
}

const std::vector<Vec3> simple{{0.0, 0.0, 0.0}};
const std::vector<Vec3> face_centred{{0.0, 0.0, 0.0}, {0.5, 0.5, 0.0}, {0.5, 0.0, 0.5}, {0.0, 0.5, 0.5}};

/// Mean number of neighbours of a particle in each shell of a periodic state: g times density times the shell's volume.
std::vector<double> neighbours(const State& state, double range, std::size_t bins) {
    const analysis::PairCorrelation found = analysis::pair_correlation(state, range, bins);
    const double density = static_cast<double>(state.particles.size()) / state.box.volume();
    std::vector<double> counts;
    for (std::size_t bin = 0; bin < bins; ++bin) {
        const double width = range / static_cast<double>(bins), inside = static_cast<double>(bin) * width;
        CHECK(found.distance[bin] == relative(inside + 0.5 * width, 1e-12));
        const double cubes = std::pow(inside + width, 3) - std::pow(inside, 3);
        counts.push_back(found.g[bin] * density * 4.0 / 3.0 * std::numbers::pi * cubes);
    }
    return counts;
}

void check_shells(const std::vector<double>& found, const std::vector<double>& wanted) {
    REQUIRE(found.size() == wanted.size());
    for (std::size_t bin = 0; bin < wanted.size(); ++bin) {
        CAPTURE(bin);
        CHECK(std::abs(found[bin] - wanted[bin]) < 1e-9);
    }
}

}  // namespace

TEST_CASE("histogram: counts by hand, the largest value in the last bin") {
    const std::vector<double> values{0.0, 0.9, 1.0, 1.5, 3.9, 4.0};
    using Counts = std::vector<std::size_t>;
    const analysis::Histogram found = analysis::histogram_of(values, 4, 0.0);
    CHECK(found.edges == std::vector{0.0, 1.0, 2.0, 3.0, 4.0});
    CHECK(found.counts == Counts{2, 2, 0, 2});
    CHECK(analysis::histogram_of(std::vector{2.0, 2.0}, 3, 2.0).counts == Counts{2, 0, 0});  // no width
    CHECK(analysis::histogram_of({}, 2, 1.0).counts == Counts{0, 0});
}

TEST_CASE("histogram: the first and the last edge are the least and the largest value, bit by bit") {
    std::mt19937_64 bits(3);
    for (std::size_t bins = 1; bins < 60; ++bins) {
        std::vector<double> values;
        for (int value = 0; value < 50; ++value) values.push_back(1e-7 * (0.5 + static_cast<double>(bits() >> 11) * 0x1p-53));
        const auto [least, most] = std::ranges::minmax(values);
        const analysis::Histogram found = analysis::histogram_of(values, bins, least);
        CHECK(found.edges.front() == least);
        CHECK(found.edges.back() == most);
        std::size_t counted = 0;
        for (const std::size_t count : found.counts) counted += count;
        CHECK(counted == 50);
    }
}

TEST_CASE("histogram: mean and deviation by hand") {
    const auto spread = analysis::spread_of(std::vector{1.0, 2.0, 3.0, 6.0});
    REQUIRE(spread.has_value());
    CHECK(spread->mean == 3.0);
    CHECK(spread->standard_deviation == relative(std::sqrt(14.0 / 4.0), 1e-15));
    CHECK(spread->minimum == 1.0);
    CHECK(spread->maximum == 6.0);
    CHECK_FALSE(analysis::spread_of({}).has_value());
}

TEST_CASE("pair correlation: the shells of simple and face-centred cubic lattices") {
    // Distances over the edge: 1, sqrt 2, sqrt 3, 2, sqrt 5 have 6, 12, 8, 6, 24 neighbours.
    check_shells(neighbours(lattice(6, 1e-7, simple, Vec3::Zero()), 2.3e-7, 23),
                 {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 6, 0, 0, 0, 12, 0, 0, 8, 0, 0, 6, 0, 24});
    // sqrt 1/2, 1, sqrt 3/2, sqrt 2: 12, 6, 24, 12.
    check_shells(neighbours(lattice(5, 1e-7, face_centred, Vec3::Zero()), 1.5e-7, 15),
                 {0, 0, 0, 0, 0, 0, 0, 12, 0, 0, 6, 0, 24, 0, 12});
}

TEST_CASE("pair correlation: a distance at the edge of a shell counts in the outer one, wherever the lattice lies") {
    std::mt19937_64 bits(7);
    const auto uniform = [&] { return static_cast<double>(bits() >> 11) * 0x1p-53; };
    for (int trial = 0; trial < 20; ++trial) {
        const Vec3 shift = 6e-7 * Vec3(uniform(), uniform(), uniform());
        // Distances 1, 2 and 3 lie on edges; the last one, at the end, belongs to no shell.
        check_shells(neighbours(lattice(7, 1e-7, simple, shift), 3e-7, 3), {0, 6 + 12 + 8, 6 + 24 + 24 + 12});
    }
}

TEST_CASE("pair correlation: images count, also of a particle with itself") {
    State state;
    state.box.lengths = {1.0, 2.0, 3.0};
    state.particles.position = {{0.3, 0.3, 0.3}};
    state.particles.radius = {0.1};
    // Up to 3.2: (1,0,0), (0,1,0) and (2,0,0), (1,1,0), (2,1,0), (0,0,1) and (3,0,0), (1,0,1); each with its signs.
    check_shells(neighbours(state, 3.2, 32), [] {
        std::vector<double> wanted(32);
        wanted[10] = 2, wanted[20] = 2 + 2, wanted[22] = 4, wanted[28] = 4, wanted[30] = 2 + 2, wanted[31] = 4;
        return wanted;
    }());
}

TEST_CASE("pair correlation: of a body with free faces only what lies a range inside is a centre") {
    State state = lattice(9, 1.0, simple, Vec3::Constant(0.5));
    state.box.periodic = {true, false, false};
    const analysis::PairCorrelation found = analysis::pair_correlation(state, 2.5, 5);
    CHECK(found.centres == 9 * 3 * 3);  // layers 3 to 5 of 0 to 8 lie 2.5 inside
    const double density = 81.0 / (9.0 * 3.0 * 3.0), shell = 4.0 / 3.0 * std::numbers::pi * (3.375 - 1.0);
    CHECK(found.g[2] == relative((6.0 + 12.0) / (density * shell), 1e-12));
    CHECK_THROWS_WITH_AS(analysis::pair_correlation(state, 4.5, 5), doctest::Contains("shorter --range"), Error);
}
