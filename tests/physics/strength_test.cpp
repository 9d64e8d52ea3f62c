// strength_test.cpp: bars that fail bond by bond: the first break by beam theory, the sequence, and what breaking must leave alone.
#include "bending/calibration.h"
#include "bending/failure.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/parallel.h"
#include "physics/bending.h"
#include "physics/hertz.h"
#include "tests/physics/bar_files.h"
#include "tests/physics/bonded_lattice.h"
#include "tests/physics/relative.h"
#include "bending/equilibria.h"
#include "bending/result_document.h"
#include "bending/seating.h"
#include "io/json.h"

using namespace kiln;
using namespace kiln::bending;
using test::relative;

namespace {

Options brittle() {
    Options options;
    options.tensile_strength = 300e6;
    return options;
}

Result failed(State state, const Options& options = brittle()) {
    return bend_to_failure(std::move(state), options);
}

double strength_of(const Result& result) {
    return physics::bending_strength(result.peak_force, result.fixture.span, result.specimen.size[1], result.specimen.size[2]);
}

}  // namespace

TEST_CASE("a chain breaks beside the punch, at the force that bends that bond to its strength: F = pi r3 sigma/(L - l)") {
    // Eleven spheres; the cylinders stand under the second, the tenth and above the sixth.
    const State state = test::make_lattice({.cells = {11, 1, 1}, .periodic = false});
    Options options = brittle();
    options.span = 8e-7;
    const Result result = failed(state, options);
    const double r = state.bonds->radius.front(), l = 1e-7;
    const double expected = std::numbers::pi * r * r * r * options.tensile_strength / (options.span - l);
    CHECK(result.curve[1].force == relative(expected, 2e-3));
    CHECK(result.peak_force == result.curve[1].force);
    CHECK(result.held_span == relative(options.span, 1e-6));
    CHECK(result.breaks == 1);
    CHECK(result.curve.back().force == 0.0);
    const auto first = static_cast<std::size_t>(std::find(result.broken.begin(), result.broken.end(), 1) - result.broken.begin());
    REQUIRE(first < result.broken.size());
    const auto [i, j] = result.specimen.body.network.pair[first];
    const double middle = (result.specimen.body.network.position[static_cast<std::size_t>(i)][0] +
                           result.specimen.body.network.position[static_cast<std::size_t>(j)][0]) /
                          2.0;
    CHECK(std::abs(middle - result.fixture.middle) == relative(l / 2.0, 1e-9));
}

TEST_CASE("a chain held by its shear strength breaks between a support and the punch: F/2 on the section of every bond there") {
    const State state = test::make_lattice({.cells = {11, 1, 1}, .periodic = false});
    Options options;
    options.span = 8e-7;
    options.shear_strength = 100e6;
    const Result result = failed(state, options);
    const double r = state.bonds->radius.front();
    CHECK(result.curve[1].force == relative(2.0 * std::numbers::pi * r * r * options.shear_strength, 2e-3));
}

TEST_CASE("breaks follow one another: each bond once, work is spent, broken bonds carry nothing, the force falls far") {
    const Result result = failed(test::make_rough_bar({20, 4, 4}));
    CHECK(result.converged);
    CHECK(result.breaks > 3);
    CHECK(result.curve.size() == result.breaks + 2);
    std::vector<std::int32_t> order;
    for (std::size_t bond = 0; bond < result.broken.size(); ++bond) {
        if (result.broken[bond] == 0) continue;
        order.push_back(result.broken[bond]);
        CHECK(result.loads[bond].force.norm() < 1e-3 * result.peak_force);
    }
    std::sort(order.begin(), order.end());
    for (std::size_t k = 0; k < order.size(); ++k) CHECK(order[k] == static_cast<std::int32_t>(k) + 1);
    CHECK(order.size() == result.breaks);
    CHECK(result.failure.dissipated > 0.0);
    CHECK(result.energy_error < 0.01);
    CHECK(result.curve.back().force <= 0.1 * result.peak_force);
    const State bent = bent_state(result);
    CHECK(std::any_of(bent.bonds->other.begin(), bent.bonds->other.end(),
                      [](const NamedArray& each) { return each.name == "broken"; }));
}

TEST_CASE("a chain that breaks spends all that it stored: bonds F_t2/(2 k_t) + M2/(2 k_bend), contacts 2/5 F h") {
    const State state = test::make_lattice({.cells = {11, 1, 1}, .periodic = false});
    Options options = brittle();
    options.span = 8e-7;
    const Result result = failed(state, options);
    const double F = result.curve[1].force, l = 1e-7;
    const physics::BondStiffness& k = result.specimen.body.network.stiffness.front();
    double stored = 0.0;
    for (int bond = 0; bond < 4; ++bond) {
        const double moment = F / 2.0 * (bond + 0.5) * l;
        stored += 2.0 * (F * F / 4.0 / (2.0 * k.shear) + moment * moment / (2.0 * k.bending));
    }
    const Material& alumina = state.materials.front();
    const double modulus = physics::contact_modulus(*alumina.young_modulus, *alumina.poisson_ratio);
    const double radius = state.particles.radius.front();
    for (const double force : {F, F / 2.0, F / 2.0}) stored += 0.4 * force * physics::hertz_overlap(modulus, radius, force);
    CHECK(result.failure.dissipated == relative(stored, 1e-6));
    CHECK(result.failure.work == relative(stored, 1e-6));
    CHECK(result.failure.stored == 0.0);
}

TEST_CASE("what breaks dissipate is what bars with and without the bond store under a punch at the same place, each solved alone") {
    Options options = brittle();
    options.until = 0.7;
    const Result result = failed(test::make_rough_bar({20, 4, 4}), options);
    REQUIRE(result.breaks >= 3);
    CHECK(result.energy_error < 0.01);
    Options exact = options;
    exact.tolerance = 1e-8;
    Result alone;
    alone.specimen = cut_specimen(test::make_rough_bar({20, 4, 4}), options.model);
    alone.fixture = result.fixture;
    seat_bar(alone.specimen, alone.fixture, exact);
    const mechanics::BondNetwork& network = alone.specimen.body.network;
    const auto spheres = mechanics::elastic_spheres(alone.specimen.state, alone.specimen.body);
    // J, after so many breaks, from the force (N) of one of them.
    const auto energy_at = [&](double punch, double force, std::size_t breaks) {
        Equilibria bar(alone.specimen, alone.fixture, exact);
        for (std::size_t bond = 0; bond < network.bonds(); ++bond) {
            const std::int32_t place = result.broken[bond];
            if (place == 0 || place > static_cast<std::int32_t>(breaks)) continue;
            bar.soften(bond, 1e-6, mechanics::contact_between(network, spheres, network.pair[bond][0], network.pair[bond][1]));
        }
        for (int trial = 0; trial < 20; ++trial) {
            const Level level = bar.at(force, alone);
            if (std::abs(level.point.punch - punch) <= 1e-7 * punch) return level.energy;
            force += (punch - level.point.punch) / level.compliance;
        }
        return 0.0;
    };
    double dissipated = 0.0;
    for (std::size_t next = 1; next <= result.breaks; ++next) {
        const Point& here = result.curve[next];
        dissipated += energy_at(here.punch, here.force, next - 1) - energy_at(here.punch, here.force, next);
    }
    CHECK(result.failure.dissipated == relative(dissipated, 1e-3));
}

TEST_CASE("a break that takes away what the punch pressed on: work is positive, and what is stored and spent") {
    for (const char* name : {"strength_energy_small.kiln", "pressed_particle_lost.kiln"}) {
        const Result result = failed(test::bar_of_file(name));
        const Point& last = result.curve[result.curve.size() - 2];
        CHECK(result.failure.work > 0.0);
        CHECK(result.failure.work < result.peak_force * last.punch);
        CHECK(result.failure.work == relative(result.failure.stored + result.failure.dissipated, 5e-3));
        CHECK(result.energy_error < 5e-3);
    }
}

TEST_CASE("the next bond breaks where stress grows much faster than the force: the search stays between the forces it has tried") {
    Options options;
    options.shear_strength = 4445.34e6;
    const Result result = failed(test::bar_of_file("no_punch_force.kiln"), options);
    CHECK(result.breaks > 5);
    CHECK(result.curve.size() == result.breaks + 2);
    CHECK(result.energy_error < 5e-3);
}

TEST_CASE("bending strength does not depend on the scale, and doubles with the bonds' where contacts stay as they are") {
    Options options = brittle();
    options.until = 0.9;
    const double strength = strength_of(failed(test::make_rough_bar({16, 3, 3}), options));
    for (const double edge : {1e-9, 1.0}) {
        CHECK(strength_of(failed(test::make_rough_bar({16, 3, 3}, edge), options)) == relative(strength, 1e-8));
    }
    options.tensile_strength *= 2.0;
    CHECK(strength_of(failed(test::make_rough_bar({16, 3, 3}), options)) == relative(2.0 * strength, 0.1));
}

TEST_CASE("a bar softened step by step is the bar that was soft from the start") {
    Result result;
    Options options;
    options.tolerance = 1e-8;
    result.specimen = cut_specimen(test::make_rough_bar({16, 4, 4}), options.model);
    result.fixture = place_fixture(result.specimen, options);
    Equilibria sequence(result.specimen, result.fixture, options);
    const double force = 1e-8;
    const double whole = sequence.at(force, result).point.deflection;
    mechanics::BondNetwork& network = result.specimen.body.network;
    const auto spheres = mechanics::elastic_spheres(result.specimen.state, result.specimen.body);
    for (std::size_t bond = network.bonds() / 2; bond < network.bonds() / 2 + 8; ++bond) {
        mechanics::PairContact ends = mechanics::contact_between(network, spheres, network.pair[bond][0], network.pair[bond][1]);
        ends.gap = 1.0;  // m: never closed
        sequence.soften(bond, 1e-3, ends);
        for (double* k : {&network.stiffness[bond].normal, &network.stiffness[bond].shear, &network.stiffness[bond].torsion,
                          &network.stiffness[bond].bending})
            *k *= 1e-3;
    }
    const double softened = sequence.at(force, result).point.deflection;
    Equilibria fresh(result.specimen, result.fixture, options);
    CHECK(softened > 1.01 * whole);
    CHECK(fresh.at(force, result).point.deflection == relative(softened, 1e-6));
    CHECK(result.converged);
}

TEST_CASE("failure: the same bytes for any number of threads") {
    const int before = threads();
    std::vector<std::string> documents;
    Options options = brittle();
    options.until = 0.9;
    for (const int count : {1, 2}) {
        set_threads(count);
        const Result result = failed(test::make_rough_bar({26, 8, 8}), options);
        documents.push_back(document(result, options, Json::array()).dump() + Json(result.broken).dump());
    }
    set_threads(before);
    CHECK(documents[0] == documents[1]);
}

TEST_CASE(
    "calibrated: a chain's bonds get the strength sigma = F (L - l)/(pi r3) of the force that was asked for, and break there") {
    const State state = test::make_lattice({.cells = {11, 1, 1}, .periodic = false});
    Options options;
    options.span = 8e-7;
    options.calibrate_to = 40e6;
    const Result result = bend_calibrated(state, options);
    REQUIRE(result.calibration);
    CHECK(result.converged);
    CHECK(strength_of(result) == relative(options.calibrate_to, 2e-3));
    const Vec3& size = result.specimen.size;
    const double force = options.calibrate_to * size[1] * size[2] * size[2] / (1.5 * options.span);
    const double r = state.bonds->radius.front(), l = 1e-7;
    const double expected = force * (options.span - l) / (std::numbers::pi * r * r * r);
    CHECK(result.calibration->tensile_strength == relative(expected, 4e-3));
    options.calibrate_to = 0.0;
    options.tensile_strength = result.calibration->tensile_strength;
    CHECK(strength_of(failed(state, options)) == relative(40e6, 2e-3));
}

TEST_CASE("calibrated: twice the strength of a rough bar takes bonds nearly twice as strong") {
    const State state = test::make_rough_bar({20, 4, 4});
    Options options;
    options.calibrate_to = 20e6;
    const Result weak = bend_calibrated(state, options);
    options.calibrate_to = 40e6;
    const Result strong = bend_calibrated(state, options);
    CHECK(strong.calibration->tensile_strength == relative(2.0 * weak.calibration->tensile_strength, 0.05));
    CHECK(strong.calibration->tests <= 5);
}
