// sintering_methods_test.cpp: order in time, the explicit method against the implicit one, runs taken up from a checkpoint.
#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "sintering/explicit_sintering.h"
#include "tests/physics/sintering_cases.h"

using namespace kiln;
using namespace sintering_cases;

namespace {


State explicitly_sintered(State state, double time, double mass_scaling) {
    sintering::SinteringSettings wanted = settings();
    wanted.mass_scaling = mass_scaling;
    sintering::ExplicitSintering sintering(std::move(state), wanted);
    while (sintering.time() < time) sintering.advance(time, endless);
    return sintering.state();
}

/// Sum of the particles' displacements over their number, over a radius: the momentum that a run without outer forces has gained.
double drift(const State& before, const State& after) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t row = 0; row < before.particles.size(); ++row)
        sum += after.particles.position[row] - before.particles.position[row];
    return sum.norm() / (radius * static_cast<double>(before.particles.size()));
}

State free_cluster() {
    State state = random_packing(30, 0.55, 1.0);
    state.box.periodic = {false, false, false};
    for (Vec3& position : state.particles.position) position = state.box.wrap(position);
    return state;
}

/// Face-centred cubic packing with vacancies, every particle shaken by less than the overlap: all contacts last.
State shaken_crystal() {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> shake(-1.0, 1.0);
    const double cell = 2.0 * radius * 0.96 / std::sqrt(0.5);
    constexpr int cells = 3;
    std::vector<Vec3> positions;
    for (int x = 0; x < cells; ++x)
        for (int y = 0; y < cells; ++y)
            for (int z = 0; z < cells; ++z)
                for (const Vec3& site : {Vec3(0, 0, 0), Vec3(0.5, 0.5, 0), Vec3(0.5, 0, 0.5), Vec3(0, 0.5, 0.5)}) {
                    const Vec3 shaken =
                        cell * (site + Vec3(x, y, z)) + 0.01 * radius * Vec3(shake(random), shake(random), shake(random));
                    if (shake(random) > -0.7) positions.push_back(shaken);
                }
    return state_of(positions, std::vector<double>(positions.size(), radius), Vec3::Constant(cells * cell), true);
}

}  // namespace

TEST_CASE("the implicit step is of second order in time where contacts last") {
    const State start = shaken_crystal();
    const auto positions_after = [&](int steps) {
        sintering::SinteringSettings wanted = settings(0.9);  // the length of the steps is given here, not controlled
        wanted.solver_tolerance = 1e-8;
        sintering::ImplicitSintering sintering(start, wanted);
        constexpr double time = 20.0;  // s, in which the density grows by a fifth
        for (int step = 1; step <= steps; ++step) {
            const double until = time * step / steps;
            while (sintering.time() < until) REQUIRE(sintering.advance(until, endless).converged);
        }
        State end = sintering.state();
        for (Vec3& position : end.particles.position) position = position.cwiseQuotient(end.box.lengths);
        return end.particles.position;
    };
    const std::vector<Vec3> exact = positions_after(512);
    const auto error_of = [&](int steps) {
        double sum = 0.0;
        const std::vector<Vec3> found = positions_after(steps);
        for (std::size_t row = 0; row < exact.size(); ++row) {
            Vec3 apart = found[row] - exact[row];
            for (double& component : apart) component -= std::round(component);
            sum += apart.squaredNorm();
        }
        return std::sqrt(sum);
    };
    const double coarse = error_of(32), fine = error_of(128);
    CHECK(fine > 0.0);
    CHECK(std::log(coarse / fine) / std::log(4.0) > 1.8);
}

TEST_CASE("explicit: a pair with little inertia closes by the pair law") {
    const double time = 10.0, start = 2.0 * radius - 4e-9;
    const Vec3 centre = Vec3::Constant(3e-7);
    const State pair = state_of({centre, centre + Vec3(start, 0.0, 0.0)}, {radius, radius}, Vec3::Constant(1e-6), false);
    double before = 1.0;
    for (const double scaling : {1e19, 1e18, 1e17}) {
        const double miss =
            deviation(2.0 * radius - distance(explicitly_sintered(pair, time, scaling), 0, 1), pair_law(4e-9, 0.5 * radius, time));
        CHECK(miss < 0.2 * before);
        before = miss;
    }
    CHECK(before < 1e-6);
}

TEST_CASE("explicit and implicit come to the same positions as the mass falls, periodic and free, without drift") {
    for (const bool periodic : {true, false}) {
        const State start = periodic ? sintered(random_packing(30, 0.55, 1.0), 20.0) : sintered(free_cluster(), 20.0);
        const double time = start.time + 1.0;
        sintering::SinteringSettings wanted = settings(1e-5);
        sintering::ImplicitSintering sintering(start, wanted);
        while (sintering.time() < time) sintering.advance(time, endless);
        const State expected = sintering.state();
        double before = 1.0;
        for (const double scaling : {1e19, 1e18, 1e17}) {
            const State end = explicitly_sintered(start, time, scaling);
            double apart = 0.0;
            for (std::size_t row = 0; row < end.particles.size(); ++row) {
                Vec3 between = end.particles.position[row] - expected.particles.position[row];
                if (periodic)
                    for (int axis = 0; axis < 3; ++axis)
                        between[axis] -= end.box.lengths[axis] * std::round(between[axis] / end.box.lengths[axis]);
                apart = std::max(apart, between.norm() / radius);
            }
            CHECK(apart < 0.2 * before);
            before = apart;
            if (!periodic) CHECK(drift(start, end) < 1e-9);
        }
        CHECK(before < 1e-4);
    }
}

TEST_CASE("a run taken up from its checkpoint goes on as if it had not been broken off, to the last bit") {
    const State start = random_packing(150, 0.5, 1.0);
    const auto same = [&](auto& whole, auto& first, auto& second) {
        for (int step = 0; step < 4; ++step) {
            whole.advance(40.0, endless);
            first.advance(40.0, endless);
        }
        second.restore(first.checkpoint());
        for (int step = 0; step < 4; ++step) {
            const sintering::StepRecord a = whole.advance(40.0, 0.6), b = second.advance(40.0, 0.6);
            CHECK(a.relative_density == b.relative_density);
            CHECK(a.newton == b.newton);
        }
        CHECK(whole.state().particles.position == second.state().particles.position);
        CHECK(whole.steps() == second.steps());
    };
    sintering::ImplicitSintering whole(start, settings()), first(start, settings()), second(start, settings());
    same(whole, first, second);
    sintering::SinteringSettings light = settings();
    light.mass_scaling = 1e19;
    sintering::ExplicitSintering explicit_whole(start, light), explicit_first(start, light), explicit_second(start, light);
    same(explicit_whole, explicit_first, explicit_second);
    sintering::ImplicitSintering other(random_packing(100, 0.5, 1.0), settings());
    CHECK_THROWS_WITH_AS(other.restore(first.checkpoint()), doctest::Contains("150 particles"), Error);
}
