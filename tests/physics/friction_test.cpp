// friction_test.cpp: friction of contacts: one particle pressed and dragged, bent bars against beam theory, and static against
// dynamic.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "mechanics/tangential_contacts.h"
#include "mechanics/explicit_contacts.h"
#include "physics/hertz.h"
#include "tests/physics/bar_files.h"
#include "tests/physics/bonded_lattice.h"
#include "tests/physics/relative.h"
#include "bending/dynamic_bending.h"
#include "bending/result_document.h"
#include "io/json.h"
#include "bending/static_bending.h"

using namespace kiln;
using namespace kiln::bending;
using test::relative;

namespace {

constexpr double friction = 0.4, radius = 5e-8, modulus = 4e11, shear_modulus = 9e10, overlap = 1e-10;  // m, Pa
const double pressed = physics::hertz_contact(modulus, radius, overlap).force;
const double stiffness = physics::mindlin_stiffness(shear_modulus, radius, overlap);

/// What a wall does to a particle that was pressed to the overlap and then dragged along it.
struct Dragged {
    Vec3 force;           // N, on the particle
    double stored, lost;  // J, along the wall; since the beginning
};

/// The contact of a static test, in as many steps.
class StaticContact {
   public:
    StaticContact() {
        contacts_.add(radius, modulus, shear_modulus, overlap, Vec3::Zero());
        to(overlap, Vec3::Zero());
    }
    Dragged to(double depth, const Vec3& slide) {
        Eigen::VectorXd depths(1), slides(3);
        depths << depth;
        slides << slide;
        contacts_.follow(depths);
        const Dragged here{-contacts_.potential(0, slide).force, contacts_.stored(slides), contacts_.lost(slides)};
        contacts_.keep(depths, slides);
        return here;
    }

   private:
    mechanics::TangentialContacts contacts_{friction};
};

/// The contact of a dynamic test: a particle under a punch that stands still.
class DynamicContact {
   public:
    DynamicContact() : contacts_(network(), {{radius, 4e11, 0.2}}, tooling(), friction) { to(overlap, Vec3::Zero()); }
    Dragged to(double depth, const Vec3& slide) {
        mechanics::Vector displacement(1, mechanics::Vec6::Zero()), velocity = displacement, force = displacement;
        displacement[0][2] = depth;
        velocity[0].head<3>() = slide - slide_;
        slide_ = slide;
        contacts_.add_forces(displacement, velocity, 0.0, 0.0, 1.0, force);
        const double normal = physics::hertz_contact(modulus, radius, depth).energy;
        return {Vec3(force[0][0], force[0][1], 0.0), contacts_.energy() - normal, contacts_.friction_loss()};
    }

   private:
    static const mechanics::BondNetwork& network() {
        static const mechanics::BondNetwork one{{Vec3::Zero()}, Vec3::Zero(), {}, {}, {}, {}, 1.0};
        return one;
    }
    /// So wide a cylinder that it is a plane, and no wider: overlaps are differences of its size.
    static mechanics::Tooling tooling() {
        return {{{0.0, 1e-4 + radius, 1e-4, true}}, {{0, 0, true, 0.0, -Vec3::UnitZ(), radius, modulus, shear_modulus}}};
    }
    mechanics::ExplicitContacts contacts_;
    Vec3 slide_ = Vec3::Zero();
};

Options once(double coefficient) {
    Options options;
    options.cycles = 1;
    options.friction = coefficient;
    return options;
}

Result bent(const State& state, const Options& options) { return bend_static(state, options); }

/// A slender bar with a column of particles right above each support and below the punch, so that contacts are level.
State level_bar() { return test::make_lattice({.cells = {61, 3, 3}}); }

Options level_span(double coefficient) {
    Options options = once(coefficient);
    options.span = 5e-6;
    return options;
}

double peak_stiffness(const Result& result, const Options& options) {
    const Point& peak = result.curve[static_cast<std::size_t>(options.points)];
    return peak.force / peak.deflection;
}

/// Deflection over that at the greatest force, where unloading has come down to a share of that force.
double unloaded_to(const Result& result, double share) {
    const auto peak = std::ranges::max_element(result.curve, {}, &Point::force);
    auto below = peak;
    while (below->force > share * peak->force) ++below;
    const Point &a = below[-1], &b = *below;
    const double part = (a.force - share * peak->force) / (a.force - b.force);
    return (a.deflection + part * (b.deflection - a.deflection)) / peak->deflection;
}

}  // namespace

TEST_CASE_TEMPLATE(
    "a particle pressed and dragged sticks below mu N and slips at mu N; work is stored or lost, also on the way back", Contact,
    StaticContact, DynamicContact) {
    Contact contact;
    const double limit = friction * pressed, longest = limit / stiffness, step = 0.01 * longest;
    double work = 0.0, before = 0.0;
    Vec3 place = Vec3::Zero();
    const auto drag = [&](double size, int steps) {
        Dragged now{};
        for (int k = 0; k < steps; ++k) {
            place[0] += size;
            now = contact.to(overlap, place);
            work -= 0.5 * (before + now.force[0]) * size;
            before = now.force[0];
        }
        return now;
    };
    const Dragged stuck = drag(step, 70);
    CHECK(stuck.force[0] == relative(-0.7 * limit, 1e-6));
    CHECK(stuck.lost <= 1e-12 * work);
    CHECK(stuck.stored == relative(work, 1e-6));
    const Dragged slipping = drag(step, 130);
    CHECK(-slipping.force[0] == relative(limit, 1e-9));
    CHECK(slipping.lost == relative(limit * longest, 1e-6));
    CHECK(slipping.stored + slipping.lost == relative(work, 1e-6));
    const Dragged back = drag(-step, 50);
    CHECK(back.force[0] == relative(-0.5 * limit, 1e-6));
    CHECK(back.lost == relative(slipping.lost, 1e-6));
    const Dragged reversed = drag(-step, 250);
    CHECK(reversed.force[0] == relative(limit, 1e-9));
    CHECK(reversed.lost == relative(2.0 * limit * longest, 1e-6));
    CHECK(reversed.stored + reversed.lost == relative(work, 1e-6));
}

TEST_CASE_TEMPLATE("pressing harder or less makes no energy: a growing contact keeps its force, a shrinking one its stretch",
                   Contact, StaticContact, DynamicContact) {
    Contact contact;
    const double slide = 0.5 * friction * pressed / stiffness;
    const Dragged dragged = contact.to(overlap, Vec3(slide, 0.0, 0.0));
    const Dragged grown = contact.to(4.0 * overlap, Vec3(slide, 0.0, 0.0));
    CHECK(grown.force[0] == relative(dragged.force[0], 1e-6));
    CHECK(grown.lost == relative(0.5 * dragged.stored, 1e-6));
    CHECK(grown.stored + grown.lost == relative(dragged.stored, 1e-6));
    const Dragged shrunk = contact.to(overlap, Vec3(slide, 0.0, 0.0));
    CHECK(shrunk.force[0] == relative(0.5 * dragged.force[0], 1e-6));
    CHECK(shrunk.stored + shrunk.lost == relative(dragged.stored, 1e-6));
    const Dragged apart = contact.to(-overlap, Vec3(slide, 0.0, 0.0));
    CHECK(apart.force[0] == 0.0);
    CHECK(apart.lost == relative(dragged.stored, 1e-6));
}

TEST_CASE("a contact that closes within a step slides for its share of it") {
    mechanics::TangentialContacts contacts(10.0);
    contacts.add(radius, modulus, shear_modulus, -3.0 * overlap, Vec3::Zero());
    Eigen::VectorXd depth(1);
    depth << overlap;
    contacts.follow(depth);
    CHECK(contacts.potential(0, Vec3(1e-12, 0.0, 0.0)).force[0] == relative(0.25e-12 * stiffness, 1e-12));
}

TEST_CASE("spheres that come from afar in a single step touch: contacts do not count on short steps") {
    const mechanics::BondNetwork two{{Vec3::Zero(), Vec3(10.0 * radius, 0.0, 0.0)}, Vec3::Zero(), {}, {}, {}, {}, radius};
    mechanics::ExplicitContacts contacts(two, {{radius, 4e11, 0.2}, {radius, 4e11, 0.2}}, {}, 0.0);
    mechanics::Vector displacement(2, mechanics::Vec6::Zero()), velocity = displacement, force = displacement;
    contacts.add_forces(displacement, velocity, 0.0, 0.0, 1.0, force);
    CHECK(contacts.touching_pairs() == 0);
    displacement[1][0] = -8.0 * radius - overlap;
    contacts.add_forces(displacement, velocity, 0.0, 0.0, 1.0, force);
    CHECK(contacts.touching_pairs() == 1);
    CHECK(force[1][0] > 0.0);
    CHECK(force[0][0] == -force[1][0]);
}

TEST_CASE("supports that slip thrust a slender bar together by mu F/2: that lifts its middle as in beam theory") {
    const Options rollers = level_span(0.0);
    const Result free = bent(level_bar(), rollers);
    const double compliance = 1.0 / peak_stiffness(free, rollers), L = free.fixture.span;
    CHECK(free.thrust == 0.0);
    // Chains of the bar: k_n l z2 + k_bend l each; the thrust acts where the lowest particles touch, e below the middle.
    const physics::BondStiffness& k = free.specimen.body.network.stiffness.front();
    const double l = 1e-7, rigidity = 3.0 * (2.0 * k.normal * l * l + 3.0 * k.bending) * l;
    const double e = l + 0.45e-7;
    for (const double mu : {0.1, 0.2}) {
        const Options options = level_span(mu);
        const Result held = bent(level_bar(), options);
        const double force = held.curve[6].force;
        CHECK(held.thrust == relative(mu * force / 2.0, 1e-6));
        // F/2 mu e is a moment along the whole span: it lifts the middle by M L2/(8 E I).
        const double lifted = compliance - 1.0 / peak_stiffness(held, options);
        CHECK(lifted == relative(mu * e / 2.0 * L * L / (8.0 * rigidity), 0.01));
        CHECK(held.energy_error < 3e-3);
        CHECK(held.friction_loss > 0.0);
    }
}

TEST_CASE("unloading with friction does not retrace loading, each cycle repeats the first, and more points close the balance") {
    Options options = once(0.3);
    options.cycles = 2;
    const Result result = bent(test::make_rough_bar({30, 6, 6}), options);
    REQUIRE(result.curve.size() == 25);
    CHECK(result.converged);
    for (std::size_t k = 1; k < 12; ++k) CHECK(result.curve[k + 12].deflection == relative(result.curve[k].deflection, 1e-5));
    for (std::size_t k = 1; k < 6; ++k) {
        CHECK(result.curve[12 - k].force == result.curve[k].force);
        CHECK(result.curve[12 - k].punch > 1.001 * result.curve[k].punch);
    }
    Options fine = options;
    fine.points = 24;
    CHECK(result.energy_error < 5e-3);
    CHECK(bent(test::make_rough_bar({30, 6, 6}), fine).energy_error < 0.5 * result.energy_error);
}

TEST_CASE("friction: static and dynamic bending agree in loading, unloading and thrust, within 0.2, 2 and 5 %") {
    Options options = once(0.3);
    options.points = 12;
    for (const State& state : {test::make_lattice({.cells = {14, 3, 3}}), test::make_rough_bar({14, 3, 3})}) {
        const Result still = bent(state, options);
        Options motion = options;
        motion.method = Method::motion;
        motion.max_deflection = still.curve[12].deflection;
        const Result moving = bend_dynamic(state, motion);
        const auto peak = std::ranges::max_element(moving.curve, {}, &Point::force);
        CHECK(peak->force / peak->deflection == relative(peak_stiffness(still, options), 2e-3));
        for (const double share : {0.9, 0.6, 0.3}) CHECK(unloaded_to(moving, share) == relative(unloaded_to(still, share), 0.02));
        CHECK(moving.thrust / moving.peak_force == relative(still.thrust / still.curve[12].force, 0.05));
        CHECK(moving.energy_error < 1e-3);
        CHECK(still.energy_error < 2e-3);
    }
}

TEST_CASE("friction: the same at any scale from 1 nm to 1 m, and the same bytes for any number of threads") {
    Options options = once(0.3);
    options.points = 3;
    const Result result = bent(test::make_rough_bar({16, 4, 4}), options);
    for (const double edge : {1e-9, 1.0}) {
        const Result scaled = bent(test::make_rough_bar({16, 4, 4}, edge), options);
        const double lambda = edge / 1e-7;
        CHECK(peak_stiffness(scaled, options) == relative(lambda * peak_stiffness(result, options), 1e-7));
        CHECK(scaled.friction_loss == relative(lambda * lambda * lambda * result.friction_loss, 1e-5));
    }
    const int before = threads();
    std::vector<std::string> documents;
    for (const int count : {1, 2}) {
        set_threads(count);
        documents.push_back(document(bent(test::make_rough_bar({20, 20, 6}), options), options, Json::array()).dump());
    }
    set_threads(before);
    CHECK(documents[0] == documents[1]);
}

TEST_CASE("gaps that close carry friction too") {
    std::size_t removed = 0;
    const State state = test::make_cracked_bar(30, 1e-6, removed);
    Options rough = once(0.0);
    rough.max_force = 1e-7;
    const Result smooth = bent(state, rough);
    rough.friction = 0.5;
    const Result result = bent(state, rough);
    CHECK(smooth.closed_gaps > 0);
    CHECK(result.closed_gaps > 0);
    CHECK(result.converged);
    CHECK(result.energy_error < 0.02);
}

TEST_CASE("friction at finer and finer tolerances: the same bar, balanced as wanted down to 1e-12 and finite below") {
    const State state = test::bar_of_file("friction_nonfinite.kiln");
    const Options usual = once(0.3);
    const Result expected = bent(state, usual);
    for (const double tolerance : {1e-9, 1e-10, 1e-11, 1e-12, 1e-13, 1e-14}) {
        Options fine = usual;
        fine.tolerance = tolerance;
        const Result result = bent(state, fine);
        CHECK(result.converged == (result.residual <= tolerance));
        if (tolerance >= 1e-12) CHECK(result.converged);
        CHECK(result.residual < 1e-6);
        CHECK(peak_stiffness(result, fine) == relative(peak_stiffness(expected, usual), 1e-6));
        CHECK(result.energy_error == relative(expected.energy_error, 1e-4));
    }
}
