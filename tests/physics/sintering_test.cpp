// sintering_test.cpp: sintering against its closed forms (pairs, chains, lattices), conservation, scaling, and its hard cases.
#include <doctest/doctest.h>

#include <Eigen/Geometry>

#include <algorithm>

#include "tests/physics/sintering_cases.h"

using namespace kiln;
using namespace kiln::sintering;
using namespace sintering_cases;

TEST_CASE("an isolated pair closes by the pair law, in steps of any length, from no overlap at all, equal or not") {
    const double time = 40.0;
    for (const auto& [first, second, overlap] : {std::array{50e-9, 50e-9, 2e-9}, {50e-9, 20e-9, 1e-9}, {50e-9, 50e-9, 0.0}}) {
        const double start = first + second - overlap;
        const Vec3 direction = Vec3(1.0, 2.0, -0.5).normalized();
        const Vec3 centre(2e-7, 2e-7, 2e-7);
        const State end =
            sintered(state_of({centre, centre + start * direction}, {first, second}, Vec3::Constant(1e-6), false), time);
        const double expected = pair_law(overlap, physics::reduced_radius(first, second), time);
        CHECK(deviation(first + second - distance(end, 0, 1), expected) < 1e-6);
        // No force from outside: the centre of the two stays, and they move along their line.
        const Vec3 before = centre + 0.5 * start * direction;
        CHECK((0.5 * (end.particles.position[0] + end.particles.position[1]) - before).norm() < 1e-12 * start);
        CHECK((end.particles.position[1] - end.particles.position[0]).cross(direction).norm() < 1e-9 * start);
    }
}

TEST_CASE("every contact of a straight chain closes as a pair does") {
    const double radius = 50e-9, overlap = 1e-9, time = 20.0;
    std::vector<Vec3> positions;
    for (int link = 0; link < 12; ++link) positions.emplace_back(1e-7 + link * (2.0 * radius - overlap), 1e-7, 1e-7);
    const State end = sintered(state_of(positions, std::vector<double>(12, radius), Vec3::Constant(2e-6), false), time);
    for (std::size_t link = 0; link + 1 < 12; ++link)
        CHECK(deviation(2.0 * radius - distance(end, link, link + 1), pair_law(overlap, 0.5 * radius, time)) < 1e-6);
}

TEST_CASE(
    "simple, body-centred and face-centred cubic cells follow s^3 = s0^3 + 0.84375 Delta gamma t/R^4 whatever their coordination") {
    const double radius = 50e-9, start = 0.01, time = 50.0;
    const double reached = std::cbrt(start * start * start + 0.84375 * diffusion() * surface_energy() * time / std::pow(radius, 4));
    struct Lattice {
        std::vector<Vec3> sites;  // in cells
        double contact;           // distance of nearest neighbours, in cells
        double coordination;
    };
    const Lattice lattices[] = {
        {{{0, 0, 0}}, 1.0, 6.0},
        {{{0, 0, 0}, {0.5, 0.5, 0.5}}, std::sqrt(0.75), 8.0},
        {{{0, 0, 0}, {0.5, 0.5, 0}, {0.5, 0, 0.5}, {0, 0.5, 0.5}}, std::sqrt(0.5), 12.0},
    };
    for (const Lattice& lattice : lattices) {
        const double cell = 2.0 * radius * (1.0 - start) / lattice.contact;
        std::vector<Vec3> positions;
        for (const Vec3& site : lattice.sites) positions.push_back(site * cell);
        State state = state_of(positions, std::vector<double>(positions.size(), radius), Vec3::Constant(cell), true);
        const double loose = relative_density(state) * std::pow(1.0 - start, 3);
        sintering::ImplicitSintering sintering(std::move(state), settings());
        sintering::StepRecord record{};
        while (sintering.time() < time) record = sintering.advance(time, endless);
        CHECK(deviation(sintering.relative_density(), loose / std::pow(1.0 - reached, 3)) < 1e-5);
        CHECK(record.contacts.coordination_number == lattice.coordination);
    }
}

TEST_CASE("lengths times lambda take times times lambda^4") {
    const double time = 5.0;
    const State small = sintered(random_packing(150, 0.5, 1.0), time);
    const State large = sintered(random_packing(150, 0.5, 1000.0), time * 1e12);
    CHECK(deviation(relative_density(large), relative_density(small)) < 1e-6);
    CHECK(relative_density(small) > 0.53);
}

TEST_CASE("a wanted density is met to 1e-6 and the same state is reached by way of others") {
    sintering::ImplicitSintering direct(random_packing(150, 0.5, 1.0), settings()),
        stopped(random_packing(150, 0.5, 1.0), settings());
    const auto reach = [](sintering::ImplicitSintering& sintering, double density) {
        while (sintering.relative_density() < density * (1.0 - 1e-6)) REQUIRE(sintering.advance(endless, density).converged);
        CHECK(deviation(sintering.relative_density(), density) < 1e-6);
    };
    reach(direct, 0.7);
    for (const double density : {0.55, 0.6, 0.65, 0.7}) reach(stopped, density);
    CHECK(deviation(stopped.time(), direct.time()) < 5e-3);
}

TEST_CASE("smaller tolerance, smaller error of the density at a fixed time") {
    const double time = 60.0;
    const auto density = [&](double tolerance) {
        return relative_density(sintered(random_packing(150, 0.5, 1.0), time, settings(tolerance)));
    };
    const double reference = density(1e-5);
    CHECK(deviation(density(1e-3), reference) < 1e-3);
    CHECK(deviation(density(1e-4), reference) < 3e-4);
}

TEST_CASE("particles without contacts move with the box, and a density that nothing drives to is one sentence") {
    State state = state_of({{1e-7, 1e-7, 1e-7}, {5e-7, 5e-7, 5e-7}}, {50e-9, 50e-9}, Vec3::Constant(1e-6), true);
    sintering::ImplicitSintering sintering(std::move(state), settings());
    CHECK_THROWS_WITH_AS(
        [&] {
            for (;;) sintering.advance(endless, 0.5);
        }(),
        doctest::Contains("cannot be reached"), Error);
}

TEST_CASE("axes that no contacts reach through follow those that contacts do reach through") {
    const double radius = 50e-9, spacing = 2.0 * radius - 1e-9;
    State rod =
        state_of({{0.5 * spacing, 3e-7, 3e-7}, {1.5 * spacing, 3e-7, 3e-7}}, {radius, radius}, {2.0 * spacing, 6e-7, 6e-7}, true);
    sintering::ImplicitSintering sintering(std::move(rod), settings());
    const double time = 20.0;
    while (sintering.time() < time) sintering.advance(time, endless);
    const Vec3 lengths = sintering.state().box.lengths;
    CHECK(deviation(2.0 * radius - 0.5 * lengths[0], pair_law(1e-9, 0.5 * radius, time)) < 1e-6);
    CHECK(deviation(lengths[1] / 6e-7, lengths[0] / (2.0 * spacing)) < 1e-12);
    CHECK(deviation(lengths[2], lengths[1]) < 1e-12);
}

TEST_CASE("two clusters that never touch densify each by itself and stay where the box carries them") {
    const double radius = 50e-9, overlap = 2e-9, time = 10.0;
    const Vec3 along(2.0 * radius - overlap, 0.0, 0.0), far(0.0, 4e-7, 0.0), base(2e-7, 2e-7, 2e-7);
    const State end = sintered(state_of({base, base + along, base + far, base + far + along}, std::vector<double>(4, radius),
                                        Vec3::Constant(1e-6), false),
                               time);
    for (const std::size_t row : {std::size_t{0}, std::size_t{2}})
        CHECK(deviation(2.0 * radius - distance(end, row, row + 1), pair_law(overlap, 0.5 * radius, time)) < 1e-6);
    CHECK(deviation(end.particles.position[2][1] - end.particles.position[0][1], far[1]) < 1e-12);
}

TEST_CASE("size ratios of 10 and 100 stay finite and converge") {
    for (const double ratio : {10.0, 100.0}) {
        const double large = 1e-6, small = large / ratio;
        std::vector<Vec3> positions{{0.0, 0.0, 0.0}};
        std::vector<double> radii{large};
        for (int axis = 0; axis < 3; ++axis)
            for (const double side : {-1.0, 1.0}) {
                Vec3 place = Vec3::Zero();
                place[axis] = side * (large + 0.98 * small);
                positions.push_back(place);
                radii.push_back(small);
            }
        const double time = 1e-3 * std::pow(small, 4) / (diffusion() * surface_energy());
        const State end = sintered(state_of(positions, radii, Vec3::Constant(4e-6), true), time);
        for (std::size_t row = 1; row < radii.size(); ++row) {
            const Vec3 apart = end.box.wrap(end.particles.position[row] + Vec3::Constant(2e-6)) -
                               end.box.wrap(end.particles.position[0] + Vec3::Constant(2e-6));
            CHECK(deviation(large + small - apart.norm(), pair_law(0.02 * small, physics::reduced_radius(large, small), time)) <
                  1e-4);
        }
    }
}

TEST_CASE("coincident centres and missing data are refused by name") {
    const Vec3 place(1e-7, 1e-7, 1e-7);
    CHECK_THROWS_WITH_AS(
        sintering::ImplicitSintering(state_of({place, place}, {50e-9, 50e-9}, Vec3::Constant(1e-6), true), settings()),
        doctest::Contains("particles 1 and 2 coincide"), Error);
    State poor = state_of({place}, {50e-9}, Vec3::Constant(1e-6), true);
    poor.materials[0].surface_energy.reset();
    CHECK_THROWS_WITH_AS(sintering::ImplicitSintering(std::move(poor), settings()), "material 'alumina' has no surface_energy",
                         Error);
}

TEST_CASE("spans in which nothing moves are one step, and the state stays as it was to the last digit") {
    SinteringSettings cold = settings();
    cold.schedule = physics::Schedule({{0.0, 298.15}, {3600.0, 573.15}, {7200.0, 298.15}});
    const State start = random_packing(100, 0.5, 1.0);
    ImplicitSintering sintering(start, cold);
    const State before = sintering.state();
    int steps = 0;
    for (; sintering.time() < 7200.0; ++steps) REQUIRE(sintering.advance(7200.0, endless).converged);
    CHECK(steps < 10);
    CHECK(deviation(relative_density(sintering.state()), relative_density(before)) < 1e-12);
    ImplicitSintering coarse(random_packing(100, 0.5, 1e5), settings());  // 10 mm
    const State large = coarse.state();
    while (coarse.time() < 3600.0) REQUIRE(coarse.advance(3600.0, endless).converged);
    CHECK(relative_density(coarse.state()) == relative_density(large));
}

TEST_CASE("spheres that are placed to touch do: a lattice with gaps of rounding sinters as one without overlap") {
    const double radius = 50e-9, edge = 2.0 * std::numbers::sqrt2 * radius, time = 70.0;
    const double half = 0.5 * edge;
    State lattice = state_of({{0.0, 0.0, 0.0}, {half, half, 0.0}, {half, 0.0, half}, {0.0, half, half}},
                             std::vector<double>(4, radius), Vec3::Constant(edge * (1.0 + 1e-11)), true);
    const State end = sintered(lattice, time);
    const double s = std::cbrt(0.84375 * diffusion() * surface_energy() * time / std::pow(radius, 4));  // h/2R, physics.md 6
    CHECK(deviation(relative_density(end), relative_density(lattice) / std::pow(1.0 - s, 3)) < 1e-4);
}

TEST_CASE("a step that is asked to stop leaves the state as it was") {
    SinteringSettings wanted = settings();
    int asked = 0;
    wanted.stop = [&] { return ++asked > 3; };
    ImplicitSintering sintering(random_packing(100, 0.5, 1.0), wanted);
    const State before = sintering.state();
    CHECK_THROWS_AS(for (;;) sintering.advance(60.0, endless), Interrupted);
    CHECK(sintering.time() == before.time);
    CHECK(sintering.state().particles.position == before.particles.position);
}

TEST_CASE("a step that is stopped on its way to a density leaves all that a checkpoint holds as it was") {
    int stops = 0;
    for (int allowed = 0;; allowed += 7) {  // stopped later and later, until the density is reached
        SinteringSettings wanted = settings();
        int asked = 0;
        wanted.stop = [&] { return ++asked > allowed; };
        ImplicitSintering sintering(random_packing(60, 0.5, 1.0), wanted);
        const auto before = sintering.checkpoint().numbers;
        try {
            sintering.advance(1e9, 0.5005);
            break;
        } catch (const Interrupted&) {
            ++stops;
        }
        CHECK(sintering.checkpoint().numbers == before);
    }
    CHECK(stops > 5);
}

TEST_CASE("a pressure that has no face to act on is refused by every method") {
    SinteringSettings wanted = settings();
    wanted.pressure = Vec3(1e6, 0.0, 0.0);
    wanted.fixed = {true, false, false};
    CHECK_THROWS_WITH_AS(ImplicitSintering(random_packing(20, 0.5, 1.0), wanted), doctest::Contains("moves nothing"), Error);
    CHECK_THROWS_WITH_AS(ExplicitSintering(random_packing(20, 0.5, 1.0), wanted), doctest::Contains("moves nothing"), Error);
}

TEST_CASE("an axis that is not periodic has no faces to hold, by every method") {
    SinteringSettings wanted = settings();
    wanted.fixed = {false, true, false};
    State state = random_packing(20, 0.5, 1.0);
    state.box.periodic[1] = false;
    CHECK_THROWS_WITH_AS(ImplicitSintering(state, wanted), doctest::Contains("no faces to hold along y"), Error);
    CHECK_THROWS_WITH_AS(ExplicitSintering(state, wanted), doctest::Contains("no faces to hold along y"), Error);
}
