// dynamic_test.cpp: explicit motion against closed forms, and dynamic bending against the static method.
#include "bending/dynamic_bending.h"

#include <doctest/doctest.h>

#include <cmath>

#include "core/parallel.h"
#include "tests/physics/bonded_lattice.h"
#include "tests/physics/relative.h"
#include "bending/result_document.h"
#include "io/json.h"
#include "bending/static_bending.h"

using namespace kiln;
using namespace kiln::bending;
using test::relative;

namespace {

Options dynamic_options() {
    Options options;
    options.method = Method::motion;
    options.cycles = 1;
    return options;
}

/// From a third to five sixths of the greatest force, unloading, N/m: the paper's window.
double unloading_slope(const Result& result) {
    const Point &high = result.curve[result.curve.size() - 7], &low = result.curve[result.curve.size() - 4];
    return (high.force - low.force) / (high.deflection - low.deflection);
}

double static_slope(const State& state) {
    Options options;
    options.cycles = 1;
    return unloading_slope(bend_static(state, options));
}

}  // namespace

TEST_CASE("two bonded spheres swing as leapfrog steps of omega^2 = 2 k_n/m must: sin(omega' dt/2) = omega dt/2, without decay") {
    const State state = test::make_lattice({.cells = {2, 1, 1}, .periodic = false});
    const mechanics::BondedBody body = mechanics::bonded_body(state, {});
    const double mass = 3e-18, stretch = 1e-12, omega = std::sqrt(2.0 * body.network.stiffness.front().normal / mass);
    mechanics::ExplicitMotion motion(body.network, mechanics::elastic_spheres(state, body), {mass, mass}, {}, {});
    mechanics::Vector start(2, mechanics::Vec6::Zero());
    start[1][0] = stretch;
    motion.place(start, 0.0);
    CHECK(motion.time_step() < 2.0 / omega);
    CHECK(motion.time_step() > 0.2 / omega);
    const double angle = 2.0 * std::asin(omega * motion.time_step() / 2.0);
    // The first step finds the forces only, so that the turning point is halfway through it.
    for (int step = 1; step <= 1000; ++step) {
        motion.step(0.0);
        if (step % 97 != 1) continue;
        const double now = motion.displacement()[1][0] - motion.displacement()[0][0];
        CHECK(std::abs(now / stretch - std::cos(angle * (step - 0.5)) / std::cos(angle / 2.0)) < 1e-8);
    }
}

TEST_CASE("the dynamic slope comes to the static one as the punch slows down; work is stored or dissipated") {
    const State state = test::make_lattice({.cells = {14, 3, 3}});
    const double expected = static_slope(state);
    Options options = dynamic_options();
    const Result usual = bend_dynamic(state, options);
    CHECK(unloading_slope(usual) == relative(expected, 0.01));
    CHECK(usual.energy_error < 1e-3);
    CHECK(usual.held_span == relative(bend_static(state, {}).held_span, 0.01));
    CHECK(usual.dynamic.energy.damping > 0.0);
    options.punch_velocity = 10.0 * usual.dynamic.velocity;
    const double fast = unloading_slope(bend_dynamic(state, options));
    CHECK(std::abs(fast - expected) > 3.0 * std::abs(unloading_slope(usual) - expected));
}

TEST_CASE("a punch too fast for the bar to stay in balance is named, and so is what damping took") {
    const State state = test::make_lattice({.cells = {16, 3, 3}});
    Options options = dynamic_options();
    const Result usual = bend_dynamic(state, options);
    CHECK(usual.warnings.empty());
    options.punch_velocity = 8.0 * usual.dynamic.velocity;
    const Result fast = bend_dynamic(state, options);
    REQUIRE(fast.warnings.size() == 1);
    CHECK(fast.warnings.front().find("a lower --punch-velocity") != std::string::npos);
}

TEST_CASE("mass scaled by 16: four times the time step and a quarter of the default velocity, the same curve to the last bit") {
    const State state = test::make_rough_bar({12, 3, 3});
    Options heavy = dynamic_options();
    heavy.mass_scaling = 16.0;
    const Result usual = bend_dynamic(state, dynamic_options()), scaled = bend_dynamic(state, heavy);
    CHECK(scaled.dynamic.time_step == 4.0 * usual.dynamic.time_step);
    CHECK(scaled.dynamic.velocity == 0.25 * usual.dynamic.velocity);
    CHECK(scaled.dynamic.steps == usual.dynamic.steps);
    CHECK(unloading_slope(scaled) == unloading_slope(usual));
}

TEST_CASE("the dynamic slope does not depend on the scale, from 1 nm to 1 m") {
    const double slope = unloading_slope(bend_dynamic(test::make_rough_bar({12, 3, 3}), dynamic_options()));
    for (const double edge : {1e-9, 1.0}) {
        const Result scaled = bend_dynamic(test::make_rough_bar({12, 3, 3}, edge), dynamic_options());
        CHECK(unloading_slope(scaled) == relative(edge / 1e-7 * slope, 1e-3));  // rounding decides at which step a point is read
    }
}

TEST_CASE("friction at the cylinders stiffens the bar and takes energy, and the balance holds") {
    const State state = test::make_lattice({.cells = {14, 3, 3}});
    Options rough = dynamic_options();
    rough.friction = 0.3;
    const Result free = bend_dynamic(state, dynamic_options()), held = bend_dynamic(state, rough);
    CHECK(held.dynamic.energy.friction > 0.0);
    CHECK(free.dynamic.energy.friction == 0.0);
    CHECK(held.energy_error < 0.01);
    CHECK(unloading_slope(held) > unloading_slope(free));
}

TEST_CASE("dynamic bending: the same bytes for any number of threads") {
    const int before = threads();
    Options options = dynamic_options();
    options.max_force = 1e-6;
    options.punch_velocity = 1.0;
    std::vector<std::string> documents;
    for (const int count : {1, 2}) {
        set_threads(count);
        documents.push_back(
            document(bend_dynamic(test::make_rough_bar({26, 8, 8}), options), options, Json::array()).dump());
    }
    set_threads(before);
    CHECK(documents[0] == documents[1]);
}

TEST_CASE("gaps that close are the same contacts in both methods") {
    std::size_t removed = 0;
    const State state = test::make_cracked_bar(12, 1e-6, removed);
    Options options;
    options.cycles = 1;
    const Result still = bend_static(state, options), moving = bend_dynamic(state, dynamic_options());
    CHECK(still.closed_gaps > 0);
    CHECK(moving.closed_gaps == still.closed_gaps);
    CHECK(unloading_slope(moving) == relative(unloading_slope(still), 0.01));
}

TEST_CASE("dynamic bending needs a density") {
    State state = test::make_lattice({.cells = {14, 3, 3}});
    state.materials.front().density.reset();
    CHECK_THROWS_WITH_AS(bend_dynamic(state, dynamic_options()), "material 'alumina' has no density", Error);
}
