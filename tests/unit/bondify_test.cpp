// bondify_test.cpp: the transition to bonded particles against closed forms, conservation laws, symmetries and its own sweeps.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "core/neighbours.h"
#include "tests/physics/relative.h"
#include "tests/unit/spheres.h"
#include "bonding/bondify.h"
#include "bonding/event_queue.h"

using namespace kiln;
using namespace kiln::bonding;
using kiln::test::make_state;
using kiln::test::relative;

namespace {

double sphere(double radius) { return 4.0 / 3.0 * std::numbers::pi * radius * radius * radius; }

double sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

/// Spheres of two to one in size on a disturbed cubic grid, each overlapping several others, periodic.
State make_packing(int side, unsigned seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> shift(-0.15, 0.15), size(0.4, 0.8);
    std::vector<Vec3> position;
    std::vector<double> radius;
    for (int x = 0; x < side; ++x)
        for (int y = 0; y < side; ++y)
            for (int z = 0; z < side; ++z) {
                position.push_back(Vec3(x + shift(random), y + shift(random), z + shift(random)));
                radius.push_back(size(random));
            }
    return make_state(position, radius, side, true);
}

ShrunkSpheres shrink_line(const std::vector<double>& radius, const std::vector<Overlap>& overlaps,
                          Sharing sharing = Sharing::pair) {
    return shrink_exactly(radius, overlaps, sharing);
}

/// Radii by the plainest way to the exact limit: go to the nearest separation, stop that pair, look at all pairs again.
std::vector<double> shrink_all(const State& state) {
    std::vector<double> radius = state.particles.radius;
    std::vector<Pair> pairs = find_pairs(state.box, state.particles.position, radius);
    while (!pairs.empty()) {
        std::vector<double> rate(radius.size());
        for (const Pair& pair : pairs)
            for (const std::int32_t row : {pair.i, pair.j}) rate[static_cast<std::size_t>(row)] += 1.0;
        const auto left = [&](const Pair& pair) {
            const auto i = static_cast<std::size_t>(pair.i), j = static_cast<std::size_t>(pair.j);
            return (radius[i] + radius[j] - pair_vector(state.box, state.particles.position, pair).norm()) / (rate[i] + rate[j]);
        };
        const auto nearest = std::ranges::min_element(pairs, {}, left);
        const double step = left(*nearest);
        for (std::size_t row = 0; row < radius.size(); ++row) radius[row] -= rate[row] * step;
        pairs.erase(nearest);
    }
    return radius;
}

}  // namespace

TEST_CASE("bondify: two equal spheres end with radius d/2 and a bond of what they lost") {
    for (const double scale : {1e-9, 1.0}) {
        const double radius = 50.0 * scale, distance = 90.0 * scale;
        const ShrunkSpheres shrunk = shrink_line({radius, radius}, {{0, 1, distance}});
        CHECK(shrunk.radius[0] == relative(distance / 2.0, 1e-15));
        CHECK(shrunk.radius[1] == relative(distance / 2.0, 1e-15));
        CHECK(shrunk.volume[0] == relative(2.0 * (sphere(radius) - sphere(distance / 2.0)), 1e-13));
    }
}

TEST_CASE("bondify: two unequal spheres lose the same length") {
    const ShrunkSpheres shrunk = shrink_line({50.0, 30.0}, {{0, 1, 72.0}});
    CHECK(shrunk.radius[0] == relative(46.0, 1e-12));
    CHECK(shrunk.radius[1] == relative(26.0, 1e-12));
    CHECK(shrunk.volume[0] == relative(sphere(50.0) - sphere(46.0) + sphere(30.0) - sphere(26.0), 1e-12));
}

TEST_CASE("bondify: three in a row, the middle one shrinks twice as fast") {
    const ShrunkSpheres pair = shrink_line({50.0, 50.0, 50.0}, {{0, 1, 94.0}, {1, 2, 94.0}});
    CHECK(pair.radius[0] == relative(48.0, 1e-12));
    CHECK(pair.radius[1] == relative(46.0, 1e-12));
    CHECK(pair.volume[0] == relative(sphere(50.0) - sphere(48.0) + (sphere(50.0) - sphere(46.0)) / 2.0, 1e-12));
    CHECK(pair.volume[1] == relative(pair.volume[0], 1e-12));

    const ShrunkSpheres particle = shrink_line({50.0, 50.0, 50.0}, {{0, 1, 94.0}, {1, 2, 94.0}}, Sharing::particle);
    CHECK(particle.radius[0] == relative(47.0, 1e-12));
    CHECK(particle.radius[1] == relative(47.0, 1e-12));
    CHECK(particle.volume[0] == relative(1.5 * (sphere(50.0) - sphere(47.0)), 1e-12));
}

TEST_CASE("bondify: after the first separation the other pair goes on alone, by hand") {
    // Overlaps 3 and 9: the first ends at s = 1 with radii 49, 48, 49; the second has 6 left, 3 from each: 46 and 45.
    const ShrunkSpheres shrunk = shrink_line({50.0, 50.0, 50.0}, {{0, 1, 97.0}, {1, 2, 91.0}});
    CHECK(shrunk.radius[0] == relative(49.0, 1e-12));
    CHECK(shrunk.radius[1] == relative(45.0, 1e-12));
    CHECK(shrunk.radius[2] == relative(46.0, 1e-12));
    const double shared = (sphere(50.0) - sphere(48.0)) / 2.0;
    CHECK(shrunk.volume[0] == relative(sphere(50.0) - sphere(49.0) + shared, 1e-12));
    CHECK(shrunk.volume[1] == relative(sphere(50.0) - sphere(46.0) + shared + sphere(48.0) - sphere(45.0), 1e-12));
}

TEST_CASE("bondify: a particle that overlaps its own periodic images ends with half the box edge") {
    State state = make_state({Vec3(0.3, 0.3, 0.3)}, {0.55}, 1.0, true);
    const Summary summary = bonding::bondify(state, Options());
    CHECK(summary.pairs == 3);
    CHECK(state.particles.radius[0] == relative(0.5, 1e-14));
    for (const double volume : state.bonds->volume) CHECK(volume == relative((sphere(0.55) - sphere(0.5)) / 3.0, 1e-12));
    for (const double radius : state.bonds->radius)
        CHECK(physics::bond_volume(1.0, 0.5, 0.5, radius, physics::BondVolume::cylinder) ==
              relative(state.bonds->volume[0], 1e-12));
}

TEST_CASE("bondify: volume is conserved and nothing overlaps in a packing, for either sharing") {
    for (const Sharing sharing : {Sharing::pair, Sharing::particle}) {
        State state = make_packing(8, 7);
        const double before = particle_volume(state.particles);
        Options options;
        options.sharing = sharing;
        const Summary summary = bonding::bondify(state, options);
        CHECK(summary.pairs > 1000);
        CHECK(particle_volume(state.particles) + sum(state.bonds->volume) == relative(before, 1e-12));
        CHECK(std::abs(summary.volume_error) < 1e-13);
        for (std::size_t bond = 0; bond < state.bonds->size(); ++bond) {
            const auto [first, second] = state.bonds->pair[bond];
            const double distance = bond_vector(state, *state.bonds, bond).norm();
            const double reach = state.particles.radius[static_cast<std::size_t>(first)] +
                                 state.particles.radius[static_cast<std::size_t>(second)];
            CHECK(reach <= distance * (1.0 + 1e-12));
            CHECK(state.bonds->volume[bond] > 0.0);
        }
        std::vector<double> reach = state.particles.radius;
        for (double& radius : reach) radius *= 1.0 - 1e-12;
        CHECK(find_pairs(state.box, state.particles.position, reach).empty());
    }
}

TEST_CASE("bondify: the event queue agrees with a search through all pairs for each separation") {
    State state = make_packing(4, 11);
    const std::vector<double> radius = shrink_all(state);
    bonding::bondify(state, Options());
    for (std::size_t row = 0; row < radius.size(); ++row) CHECK(state.particles.radius[row] == relative(radius[row], 1e-12));
}

TEST_CASE("bondify: the order of the particles and mirroring do not matter") {
    State state = make_packing(5, 3), mirrored = state;
    const std::size_t count = state.particles.size();
    std::vector<std::int32_t> order(count);
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), std::mt19937_64(5));
    mirrored.particles = take_rows(state.particles, order);
    for (Vec3& position : mirrored.particles.position) position[0] = -position[0];
    const Summary one = bonding::bondify(state, Options());
    const Summary two = bonding::bondify(mirrored, Options());
    for (std::size_t row = 0; row < count; ++row)
        CHECK(mirrored.particles.radius[row] ==
              relative(state.particles.radius[static_cast<std::size_t>(order[row])], 1e-12));
    CHECK(two.mean_diameter == relative(one.mean_diameter, 1e-12));
    CHECK(two.mean_length == relative(one.mean_length, 1e-12));
}

TEST_CASE("bondify: a regular packing, where all events fall together, keeps its symmetry") {
    std::vector<Vec3> position;
    for (int x = 0; x < 3; ++x)
        for (int y = 0; y < 3; ++y)
            for (int z = 0; z < 3; ++z) position.emplace_back(x, y, z);
    State state = make_state(position, std::vector<double>(27, 0.53), 3.0, true);
    const Summary summary = bonding::bondify(state, Options());
    CHECK(summary.bonds == 81);
    for (const double radius : state.particles.radius) CHECK(radius == relative(0.5, 1e-14));
    for (const double volume : state.bonds->volume) CHECK(volume == relative((sphere(0.53) - sphere(0.5)) / 3.0, 1e-12));
}

TEST_CASE("bondify: a metre and a nanometre give the same shape") {
    State metres = make_packing(5, 9), nanometres = metres;
    nanometres.box.lengths *= 1e-9;
    for (Vec3& position : nanometres.particles.position) position *= 1e-9;
    for (double& radius : nanometres.particles.radius) radius *= 1e-9;
    bonding::bondify(metres, Options());
    bonding::bondify(nanometres, Options());
    REQUIRE(metres.bonds->size() == nanometres.bonds->size());
    for (std::size_t bond = 0; bond < metres.bonds->size(); ++bond) {
        CHECK(nanometres.bonds->radius[bond] * 1e9 == relative(metres.bonds->radius[bond], 1e-9));
        CHECK(nanometres.bonds->length[bond] * 1e9 == relative(metres.bonds->length[bond], 1e-9));
    }
}

TEST_CASE("bondify: sweeps come closer to the exact limit in proportion to the decrement") {
    for (const Sharing sharing : {Sharing::pair, Sharing::particle}) {
        const State start = make_packing(5, 21);
        State exact = start;
        Options options;
        options.sharing = sharing;
        bonding::bondify(exact, options);
        options.method = Method::sweep;
        std::vector<double> errors;
        for (const double decrement : {4e-4, 2e-4, 1e-4, 5e-5}) {
            State swept = start;
            options.decrement = decrement;
            const Summary summary = bonding::bondify(swept, options);
            CHECK(std::abs(summary.volume_error) < 1e-12);
            double error = 0.0;
            for (std::size_t bond = 0; bond < exact.bonds->size(); ++bond)
                error += std::abs(swept.bonds->volume[bond] - exact.bonds->volume[bond]);
            errors.push_back(error / sum(exact.bonds->volume));
        }
        CHECK(errors.front() < 0.05);
        const double order = std::log2(errors.front() / errors.back()) / 3.0;
        CHECK(order > 0.9);
        CHECK(order < 1.1);
    }
}

TEST_CASE("bondify: sweeps stop when they are asked to, and leave the state alone") {
    State state = make_packing(4, 2);
    const std::vector<double> radius = state.particles.radius;
    Options options;
    options.method = Method::sweep;
    options.decrement = 1e-3;
    CHECK_THROWS_AS(bonding::bondify(state, options, {.stop = [] { return true; }, .progress = {}}), Interrupted);
    CHECK(state.particles.radius == radius);
    CHECK_FALSE(state.bonds);
}

TEST_CASE("bondify: a small particle deep inside a large one stops, the large one gives the rest") {
    const State start = make_state({Vec3(2, 2, 2), Vec3(2.6, 2, 2)}, {1.0, 0.1}, 5.0, false);
    for (const Method method : {Method::exact, Method::sweep}) {
        State state = start;
        Options options;
        options.method = method;
        options.decrement = 1e-6;
        const Summary summary = bonding::bondify(state, options);
        CHECK(summary.stopped == 1);
        CHECK(state.particles.radius[1] == relative(min_share * 0.1, 1e-12));
        CHECK(state.particles.radius[0] == relative(0.599, 1e-5));
        CHECK(std::abs(summary.volume_error) < 1e-12);
        CHECK(summary.clamped == 1);
        CHECK(state.bonds->radius[0] == state.particles.radius[1]);
    }
}

TEST_CASE("bondify: coincident centres are refused with both ids") {
    State state = make_state({Vec3(2, 2, 2), Vec3(2, 2, 2)}, {1.0, 0.5}, 9.0, false);
    state.particles.id = {17, 902};
    CHECK_THROWS_WITH_AS(bonding::bondify(state, Options()), doctest::Contains("particles 17 and 902"), Error);
}

TEST_CASE("bondify: thin bonds are counted, and left out with their volume if so wished") {
    // The pair 1-2 barely overlaps; the deep overlap 0-1 pulls it apart at once.
    const State start = make_state({Vec3(1, 5, 5), Vec3(2.6, 5, 5), Vec3(4.5999999, 5, 5)}, {1.0, 1.0, 1.0}, 10.0, false);
    State kept = start, dropped = start;
    Options options;
    const Summary keep = bonding::bondify(kept, options);
    CHECK(keep.bonds == 2);
    CHECK(keep.thin == 1);
    CHECK(keep.dropped_volume == 0.0);
    options.drop_thin = true;
    const Summary drop = bonding::bondify(dropped, options);
    CHECK(drop.bonds == 1);
    CHECK(drop.thin == 1);
    CHECK(drop.dropped_volume == relative(kept.bonds->volume[1], 1e-12));
    CHECK(dropped.bonds->pair[0] == std::array<std::int32_t, 2>{0, 1});
}
