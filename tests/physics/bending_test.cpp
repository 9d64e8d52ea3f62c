// bending_test.cpp: static three-point bending against beam theory, its independence of scale, load and fixture, and its hard
// cases.
#include "physics/bending.h"

#include <doctest/doctest.h>

#include <bit>
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

Result tested(State state, const Options& options = {}) {
    return bend_static(std::move(state), options);
}

const Point& peak_of(const Result& result, const Options& options = {}) {
    return result.curve[static_cast<std::size_t>(options.points)];
}

/// From the point at half the greatest force to the one at all of it, N/m.
double slope_of(const Result& result) {
    const Point &half = result.curve[3], &full = result.curve[6];
    return (full.force - half.force) / (full.deflection - half.deflection);
}

double modulus_of(const Result& result, double span) {
    return physics::bending_modulus(slope_of(result), span, result.specimen.size[1], result.specimen.size[2],
                                    result.specimen.poisson_ratio);
}

double modulus_of(const Result& result) { return modulus_of(result, result.fixture.span); }

/// With the span between the supports' resultant forces.
double effective_modulus(const Result& result) {
    return modulus_of(result, physics::equivalent_span(result.held_span, result.fixture.span));
}

/// Bending stiffness of a bar of straight chains, N m2: for each, k_n l z2 + k_bend l.
double flexural_stiffness(const Result& result) {
    const physics::BondStiffness& k = result.specimen.body.network.stiffness.front();
    const double l = 1e-7;
    const auto rows = std::lround(result.specimen.size[2] / l), columns = std::lround(result.specimen.size[1] / l);
    double sum = 0.0;
    for (long row = 0; row < rows; ++row) {
        const double z = (static_cast<double>(row) - static_cast<double>(rows - 1) / 2.0) * l;
        sum += static_cast<double>(columns) * (k.normal * z * z + k.bending) * l;
    }
    return sum;
}

}  // namespace

TEST_CASE("a slender simple cubic bar has its own flexural stiffness within 3 %, and with its own shear within 1 %") {
    for (const int height : {4, 6, 8}) {
        const Result result = tested(test::make_lattice({.cells = {26 * height, 3, height}}));
        REQUIRE(result.fixture.span / result.specimen.size[2] >= 20.0);
        CHECK(result.converged);
        const double L = result.fixture.span, bending = L * L * L / (48.0 * flexural_stiffness(result));
        CHECK(1.0 / slope_of(result) == relative(bending, 0.03));
        const double G = result.specimen.body.network.stiffness.front().shear / 2e-7;
        const double shear = L / (4.0 * 5.0 / 6.0 * G * result.specimen.size[1] * result.specimen.size[2]);
        CHECK(1.0 / slope_of(result) == relative(bending + shear, 0.01));
    }
}

TEST_CASE("spans from 3 to 40 heights: bending and shear of a Timoshenko beam, in as many iterations for short as for long bars") {
    int most = 0, least = 1 << 30;
    for (const int slenderness : {3, 6, 12, 40}) {
        constexpr int height = 6;
        Options options;
        options.cycles = 1;
        options.span = slenderness * height * 1e-7;
        const Result result = tested(test::make_lattice({.cells = {(slenderness + 2) * height, 3, height}}), options);
        CHECK(result.converged);
        const double L = options.span, bending = L * L * L / (48.0 * flexural_stiffness(result));
        const double G = result.specimen.body.network.stiffness.front().shear / 2e-7;
        const double shear = L / (4.0 * 5.0 / 6.0 * G * result.specimen.size[1] * result.specimen.size[2]);
        // Beam theory leaves out the near field of the cylinders, which reaches as far as a share of the height.
        CHECK(1.0 / slope_of(result) == relative(bending + shear, 0.3 / slenderness));
        most = std::max(most, result.iterations);
        least = std::min(least, result.iterations);
    }
    CHECK(most < 3 * least);
}

TEST_CASE(
    "cylinders from a quarter to three heights in radius: the same modulus of a lattice within 0.2 %, and of a rough bar within "
    "2 % if its effective span is counted") {
    const State lattice = test::make_lattice({.cells = {60, 3, 6}}), rough = test::make_rough_bar({60, 6, 6});
    const double of_lattice = modulus_of(tested(lattice)), of_rough = effective_modulus(tested(rough));
    for (const double heights : {0.25, 1.5, 3.0}) {
        Options options;
        options.punch_radius = heights * 6e-7;
        CHECK(modulus_of(tested(lattice, options)) == relative(of_lattice, 2e-3));
        CHECK(effective_modulus(tested(rough, options)) == relative(of_rough, 0.02));
    }
}

TEST_CASE("spans from 4 to 14 heights: a rough bar's modulus within 2 %, by its effective span") {
    const State rough = test::make_rough_bar({100, 6, 6});
    Options options;
    options.span = 14.0 * 6e-7;
    const double modulus = effective_modulus(tested(rough, options));
    for (const double slenderness : {4.0, 6.0, 10.0}) {
        options.span = slenderness * 6e-7;
        CHECK(effective_modulus(tested(rough, options)) == relative(modulus, 0.02));
    }
}

TEST_CASE("the wanted deflection or force is met, cycles repeat, unloading retraces loading") {
    Options options;
    options.cycles = 2;
    options.points = 4;
    options.max_deflection = 3e-10;
    const Result by_deflection = tested(test::make_rough_bar({30, 6, 6}), options);
    REQUIRE(by_deflection.curve.size() == 17);
    CHECK(peak_of(by_deflection, options).deflection == relative(3e-10, 1e-5));
    CHECK(by_deflection.curve.front().force == 0.0);
    CHECK(by_deflection.curve.back().force == 0.0);
    for (std::size_t k = 0; k < 17; ++k) {
        CHECK(by_deflection.curve[k].deflection == by_deflection.curve[16 - k].deflection);
        CHECK(by_deflection.curve[k].force == by_deflection.curve[(k + 8) % 16].force);
    }
    Options by_force = options;
    by_force.max_deflection = 0.0;
    by_force.max_force = peak_of(by_deflection, options).force;
    const Result result = tested(test::make_rough_bar({30, 6, 6}), by_force);
    CHECK(peak_of(result, options).deflection == relative(3e-10, 1e-5));
    CHECK(result.curve[2].force == by_force.max_force / 2.0);
}

TEST_CASE("forces and moments of the cylinders balance, contacts only press, and travel grows with force") {
    const Result result = tested(test::make_rough_bar({36, 7, 7}));
    const std::vector<mechanics::WallContact> contacts = find_contacts(result.specimen, result.fixture).contacts;
    double up = 0.0, down = 0.0, pitch = 0.0, roll = 0.0;
    for (std::size_t c = 0; c < contacts.size(); ++c) {
        const double force = std::abs(result.peak.contact_force[c][2]);
        CHECK(result.peak.contact_force[c][2] * (contacts[c].punch ? -1.0 : 1.0) >= 0.0);
        const Vec3& x = result.specimen.body.network.position[static_cast<std::size_t>(contacts[c].node)];
        (contacts[c].punch ? down : up) += force;
        pitch += (contacts[c].punch ? -force : force) * x[0];
        roll += (contacts[c].punch ? -force : force) * x[1];
    }
    const double force = peak_of(result).force;
    CHECK(up == relative(force, 1e-9));
    CHECK(down == relative(force, 1e-9));
    CHECK(std::abs(pitch) <= 1e-9 * force * result.fixture.span);
    CHECK(std::abs(roll) <= 1e-9 * force * result.fixture.span);
    for (std::size_t k = 0; k < 6; ++k) {
        CHECK(result.curve[k + 1].punch > result.curve[k].punch);
        CHECK(result.curve[k + 1].deflection > result.curve[k].deflection);
    }
}

TEST_CASE("work of the punch is the energy stored; more points bring them closer") {
    Options coarse, fine;
    fine.points = 24;
    const double few = tested(test::make_rough_bar({30, 6, 6}), coarse).energy_error;
    const double many = tested(test::make_rough_bar({30, 6, 6}), fine).energy_error;
    CHECK(few < 2e-3);
    CHECK(many < 1e-4);
}

TEST_CASE("the modulus does not depend on the scale, from 1 nm to 1 m") {
    const double modulus = modulus_of(tested(test::make_rough_bar({30, 6, 6})));
    for (const double edge : {1e-9, 1.0})
        CHECK(modulus_of(tested(test::make_rough_bar({30, 6, 6}, edge))) == relative(modulus, 1e-8));
}

TEST_CASE("where the particles' images are does not matter") {
    State state = test::make_rough_bar({30, 6, 6});
    const Result as_built = tested(state);
    test::scatter_images(state);
    const Result moved = tested(state);
    CHECK(moved.specimen.dropped_bonds == as_built.specimen.dropped_bonds);
    CHECK(modulus_of(moved) == relative(modulus_of(as_built), 1e-7));
}

TEST_CASE("the same bytes for any number of threads, states included") {
    const int before = threads();
    std::vector<std::string> documents;
    for (const int count : {1, 2}) {
        set_threads(count);
        const Result result = tested(test::make_rough_bar({20, 20, 6}));
        documents.push_back(document(result, {}, Json::array()).dump());
        for (const Vec3& position : bent_state(result).particles.position)
            for (const double x : position) documents.back() += std::to_string(std::bit_cast<std::uint64_t>(x)) + " ";
    }
    set_threads(before);
    CHECK(documents[0] == documents[1]);
}

TEST_CASE("gaps that close under load press the particles together: neighbours without a bond, a little apart, under the punch") {
    std::size_t removed = 0;
    const State open = test::make_cracked_bar(30, 1e-5, removed), wide = test::make_cracked_bar(30, 0.05, removed);
    Options gentle, hard;
    gentle.max_deflection = 1e-13;
    hard.max_deflection = 1e-8;
    CHECK(tested(open, gentle).closed_gaps == 0);
    const Result touching = tested(open, hard), apart = tested(wide, hard);
    CHECK(touching.closed_gaps > 0);
    CHECK(touching.closed_gaps <= removed);
    CHECK(touching.converged);
    CHECK(touching.energy_error < 0.02);
    CHECK(apart.closed_gaps == 0);
    CHECK(peak_of(touching).force > peak_of(apart).force);
}

TEST_CASE("compression above, tension below") {
    const Result result = tested(test::make_lattice({.cells = {60, 4, 6}}));
    const State bent = bent_state(result);
    const auto array = [&](const std::string& name) {
        for (const NamedArray& each : bent.bonds->other) {
            if (each.name == name) return std::get<std::vector<double>>(each.array.data);
        }
        throw Error("no array " + name);
    };
    const std::vector<double> tension = array("normal_force"), tensile = array("tensile_stress"), shear = array("shear_stress");
    const double middle = result.fixture.middle;
    for (std::size_t bond = 0; bond < tension.size(); ++bond) {
        const Vec3 along = bond_vector(bent, *bent.bonds, bond);
        const Vec3 at = bent.particles.position[static_cast<std::size_t>(bent.bonds->pair[bond][0])] + along / 2.0;
        if (std::abs(along.normalized()[0]) < 0.9 || std::abs(at[0] - middle) > 0.35 * result.fixture.span) continue;
        const bool below = at[2] < result.specimen.size[2] / 2.0;
        CHECK(below == (tension[bond] > 0.0));
        CHECK(below == (tensile[bond] > 0.0));
        CHECK(shear[bond] >= 0.0);
    }
}

TEST_CASE("bonds without length, bonds down to no radius, a particle that hangs on one bond: solved and counted") {
    State state = test::make_rough_bar({30, 5, 5});
    for (double& length : state.bonds->length) length = 0.0;
    for (std::size_t bond = 0; bond < 40; ++bond) {
        state.bonds->radius[25 * bond] = state.particles.radius.front() * std::pow(10.0, -0.25 * static_cast<double>(bond));
    }
    const Result without = tested(state);
    CHECK(without.converged);
    CHECK(without.specimen.body.negligible_bonds > 20);
    CHECK(without.specimen.body.negligible_bonds < 40);

    const auto end = static_cast<std::int32_t>(state.particles.size());
    state.particles.id.push_back(end);
    state.particles.position.push_back(state.particles.position.back() + Vec3(0.0, 0.0, -0.9e-7));
    state.particles.radius.push_back(state.particles.radius.back());
    state.particles.material.push_back(0);
    state.bonds->pair.push_back({end - 1, end});
    state.bonds->image.push_back({0, 0, 0});
    state.bonds->radius.push_back(0.005 * state.particles.radius.back());
    state.bonds->length.push_back(1e-8);
    state.bonds->volume.push_back(0.0);
    const Result with = tested(state);
    CHECK(with.converged);
    CHECK(with.specimen.body.particle.size() == without.specimen.body.particle.size() + 1);
    CHECK(slope_of(with) == relative(slope_of(without), 1e-6));
}

TEST_CASE("hard cases are refused by name") {
    State state = test::make_lattice({.cells = {20, 3, 3}});
    Options options;
    options.span = 2.1e-6;
    CHECK_THROWS_WITH_AS(tested(state, options), doctest::Contains("is not shorter than the bar"), Error);
    State without = state;
    without.bonds.reset();
    CHECK_THROWS_WITH_AS(tested(without), "the state has no bonds; run bondify first", Error);

    State broken = state;
    std::vector<std::int32_t> kept;
    for (std::size_t bond = 0; bond < broken.bonds->size(); ++bond) {
        const auto [i, j] = broken.bonds->pair[bond];
        if (std::min(i, j) / 9 != 12 || std::max(i, j) / 9 != 13) kept.push_back(static_cast<std::int32_t>(bond));
    }
    broken.bonds = take_rows(*broken.bonds, kept);
    CHECK_THROWS_WITH_AS(tested(broken), doctest::Contains("the bar is in pieces: the largest, 117 of 180 particles"), Error);

    // The bar's particles stand at odd multiples of 0.05 um; thin cylinders find the gaps between them.
    Options thin;
    thin.punch_radius = 1e-9;
    thin.span = 1.5e-6;
    CHECK_THROWS_WITH_AS(tested(state, thin), "the punch touches no particle", Error);
    thin.span = 1.6e-6;
    CHECK_THROWS_WITH_AS(tested(state, thin), "a support touches no particle", Error);

    // Open ends: half the bar has no particles.
    State half = state;
    half.box.periodic = {false, false, false};
    half.box.lengths[0] = 4e-6;
    half.box.periodic[0] = true;
    CHECK_THROWS_WITH_AS(tested(half), doctest::Contains("the bar does not reach its supports"), Error);
}
