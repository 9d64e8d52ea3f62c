// schedule_test.cpp: temperature schedules: integrals against the exponential integral, equivalent time, programme against hold.
#include <doctest/doctest.h>


#include <cmath>

#include "sintering/kinetics.h"
#include "tests/physics/sintering_cases.h"
#include "io/schedule_text.h"

using namespace kiln;
using namespace sintering_cases;

namespace {

const physics::Schedule firing = io::parse_schedule("25C 10K/min 1200C 10min 20K/min 25C");

/// Integral of exp(-a/T)/T over a ramp from T1 to T2 at `rate` K/s: (E1(a/T2) - E1(a/T1))/rate, by the substitution x = a/T.
double ramp_integral(double a, double first, double last, double rate) {
    return (std::expint(-a / first) - std::expint(-a / last)) / rate;
}

}  // namespace

TEST_CASE("a schedule goes through its temperatures at its rates") {
    const double heating = 1175.0 / (10.0 / 60.0), cooling = 1175.0 / (20.0 / 60.0);
    CHECK(firing.temperature(-5.0) == 298.15);
    CHECK(deviation(firing.temperature(60.0), 308.15) < 1e-14);
    CHECK(deviation(firing.temperature(heating + 300.0), 1473.15) < 1e-14);
    CHECK(deviation(firing.end(), heating + 600.0 + cooling) < 1e-14);
    CHECK(firing.temperature(firing.end() + 1.0) == 298.15);
    CHECK(firing.highest() == 1473.15);
    CHECK(std::isinf(physics::Schedule::hold(1000.0).end()));
    CHECK(firing.from(100.0).temperature(160.0) == firing.temperature(60.0));
}

TEST_CASE("words of a schedule that do not fit are named") {
    for (const char* text : {"", "10K/min", "25C 1200C", "25C 10K/min", "25C 10K/min 1h", "25C -5K/min 100C", "25C", "25C 10K 1h"})
        CHECK_THROWS_AS(io::parse_schedule(text), TextError);
    CHECK_THROWS_WITH_AS(io::parse_schedule("25C 1200C"), doctest::Contains("'1200C'"), TextError);
}

TEST_CASE("a schedule in a laboratory's words is the same schedule") {
    for (const char* text : {"RT 10C/min 1200C 10min 20C/min RT", "25 °C 10 °C/min 1200 °C 10 min 20 K/min 25 °C",
                             "298.15K 600K/h 1473.15 K 600s 1200 C/h 25degC"}) {
        CAPTURE(text);
        const physics::Schedule same = io::parse_schedule(text);
        CHECK(deviation(same.end(), firing.end()) < 1e-14);
        for (double time = 0.0; time < firing.end(); time += 100.0)
            CHECK(deviation(same.temperature(time), firing.temperature(time)) < 1e-13);
    }
    CHECK(io::parse_schedule("RT 1d").end() == 86400.0);
    CHECK(deviation(io::parse_schedule("RT 20 us").end(), 20e-6) < 1e-14);
}

TEST_CASE("a word of a schedule that does not fit is refused with the units that would") {
    CHECK_THROWS_WITH_AS(io::parse_schedule("25F 10K/min 1200C"),
                         doctest::Contains("'25F' stands where a temperature [K, C or RT] is required"), TextError);
    CHECK_THROWS_WITH_AS(
        io::parse_schedule("25C 10k/min 1200C"),
        doctest::Contains("a rate [K/s, K/min, K/h, C/s, C/min, C/h] or the time of a hold [s, ms, us, min, h, d]"), TextError);
    CHECK_THROWS_WITH_AS(io::parse_schedule("25C 10 1200C"), doctest::Contains("'10' stands where a rate"), TextError);
    CHECK_THROWS_WITH_AS(io::parse_schedule("25C 10K/min 1200 1h"), doctest::Contains("'1200' stands where the temperature"),
                         TextError);
}

TEST_CASE("the integral over a log of ten thousand rows is that of the ramp they lie on") {
    std::vector<physics::Schedule::Corner> rows;
    for (int row = 0; row <= 10000; ++row) rows.push_back({0.705 * row, 298.15 + 0.1175 * row});
    const physics::Schedule log(rows), ramp({rows.front(), rows.back()});
    const auto arrhenius = [](double temperature) { return std::exp(-57000.0 / temperature); };
    for (const auto& [from, until] : {std::pair(0.0, 7050.0), {6000.1, 6000.2}, {6999.0, 7049.9}})
        CHECK(deviation(log.integral(from, until, arrhenius), ramp.integral(from, until, arrhenius)) < 1e-12);
}

TEST_CASE("diffusion over a ramp is the exponential integral to rounding") {
    const State state = state_of({{0, 0, 0}}, {50e-9}, Vec3::Constant(1e-6), true);
    const sintering::Kinetics kinetics(state, firing);
    const Material& alumina = state.materials[0];
    const double a = *alumina.activation_energy / physics::gas_constant;
    const double factor = *alumina.atomic_volume * *alumina.diffusion_prefactor / physics::boltzmann_constant;
    const double heated = 1175.0 * 6.0;
    for (const auto& [from, until] : {std::pair(0.0, heated), {0.9 * heated, heated}, {0.97 * heated, 0.97 * heated + 1.0}}) {
        const double expected = factor * ramp_integral(a, firing.temperature(from), firing.temperature(until), 1.0 / 6.0);
        CHECK(deviation(kinetics.diffusion_over(from, until)[0], expected) < 1e-10);
    }
    const double held = kinetics.diffusion_over(heated, heated + 600.0)[0];
    CHECK(deviation(held, 600.0 * diffusion()) < 1e-12);
    CHECK(deviation(kinetics.equivalent(heated, heated + 600.0), 600.0) < 1e-12);
}

TEST_CASE("the time after an equivalent time is its inverse, on ramps, holds and across corners") {
    const sintering::Kinetics kinetics(state_of({{0, 0, 0}}, {50e-9}, Vec3::Constant(1e-6), true), firing);
    for (const double from : {0.0, 6000.0, 7000.0, 7100.0, 7700.0})
        for (const double equivalent : {1e-9, 1e-3, 1.0, 20.0}) {
            const double until = kinetics.after(from, equivalent);
            constexpr double spacing = 4e-12;  // s, of the doubles near these times
            if (std::isfinite(until)) CHECK(std::abs(kinetics.equivalent(from, until) - equivalent) < 1e-10 * equivalent + spacing);
        }
    CHECK(kinetics.after(firing.end(), 1.0) > 1e50);  // s: at 25 C nothing diffuses
}

TEST_CASE("a programme gives the density of a hold at the same integral of Delta") {
    const State start = random_packing(150, 0.5, 1.0);
    sintering::SinteringSettings programme = settings(1e-4);
    programme.schedule = io::parse_schedule("25C 10K/min 1150C 2min 10K/min 25C");
    sintering::ImplicitSintering fired(start, programme);
    while (fired.time() < programme.schedule.end()) REQUIRE(fired.advance(programme.schedule.end(), endless).converged);
    const sintering::Kinetics kinetics(start, programme.schedule);
    const double same = kinetics.diffusion_over(0.0, programme.schedule.end())[0] / diffusion();
    CHECK(deviation(fired.relative_density(), relative_density(sintered(start, same, settings(1e-4)))) < 5e-4);
    CHECK(fired.relative_density() > 0.51);
    CHECK(*fired.state().temperature == 298.15);
}
