// sintering_die_test.cpp: faces that hold but do not pull: the closed form of a lattice, limits, and what holds step by step.
#include <doctest/doctest.h>

#include <cmath>

#include "sintering/die.h"
#include "sintering/explicit_sintering.h"
#include "tests/physics/sintering_cases.h"

using namespace kiln;
using namespace sintering_cases;

namespace {

constexpr sintering::Axes xy{true, true, false};

sintering::SinteringSettings pressed(double pressure, const sintering::Axes& confined, const sintering::Axes& fixed = {}) {
    sintering::SinteringSettings wanted = settings();
    wanted.pressure = Vec3(0.0, 0.0, pressure);
    wanted.confined = confined;
    wanted.fixed = fixed;
    return wanted;
}

double largest_difference(const State& a, const State& b) {
    double most = (a.box.lengths - b.box.lengths).cwiseAbs().maxCoeff();
    for (std::size_t row = 0; row < a.particles.size(); ++row)
        most = std::max(most, (a.particles.position[row] - b.particles.position[row]).cwiseAbs().maxCoeff());
    return most;
}

}  // namespace

TEST_CASE("a face-centred lattice in a die: lateral stress and the pressure from which on the walls press, in closed form") {
    const double s = 0.05, overlap = 2.0 * radius * s, spacing = 2.0 * radius - overlap;
    const physics::ContactConstants constants;
    const double kt = physics::tangential_viscosity(constants, overlap, 0.5 * radius) / diffusion(),
                 kn = physics::normal_viscosity_factor(constants, 0.5 * radius) * overlap * overlap / diffusion();
    // Twelve links of the length l: stress_i = S + sum C_ij rate_j, tension positive, with the sintering stress S = f sqrt(8)/l^2.
    const double c11 = std::sqrt(2.0) * (kn + kt) / spacing, c12 = (kn - kt) / (std::sqrt(2.0) * spacing);
    const double s0 = std::sqrt(8.0) * physics::sintering_force(constants, 0.5 * radius, surface_energy()) / (spacing * spacing);
    // Held at the walls the rate along z is -(P + S)/C11 and the wall's stress S - (P + S) C12/C11: none at P = S (C11/C12 - 1).
    const double threshold = s0 * (c11 / c12 - 1.0), time = 1e-4 * std::pow(overlap, 3) * 0.5 * radius /
                                                            (3.375 * diffusion() * surface_energy());
    for (const double share : {0.3, 0.9, 0.99, 1.01, 1.1, 3.0}) {
        CAPTURE(share);
        const double pressure = share * threshold;
        sintering::ImplicitSintering sintering(face_centred_cell(s), pressed(pressure, xy));
        const sintering::StepRecord record = sintering.advance(time, endless);
        REQUIRE(record.converged);
        const Vec3 rate = record.strain / record.duration;
        if (share > 1.0) {
            CHECK(record.strain[0] == 0.0);
            CHECK(record.strain[1] == 0.0);
            CHECK(deviation(rate[2], -(pressure + s0) / c11) < 1e-3);
            CHECK(std::abs(record.stress[0] - (s0 - (pressure + s0) * c12 / c11)) < 2e-3 * s0);
            CHECK(record.stress[0] < 0.0);
            CHECK(record.stress[1] < 0.0);
        } else {
            // Clear of the walls: S + (C11 + C12) a + C12 c = 0 and S + 2 C12 a + C11 c = -P.
            const double determinant = (c11 + c12) * c11 - 2.0 * c12 * c12;
            CHECK(deviation(rate[0], (-s0 * c11 + (pressure + s0) * c12) / determinant) < 1e-3 / (1.0 - share));
            CHECK(deviation(rate[2], (-(pressure + s0) * (c11 + c12) + 2.0 * c12 * s0) / determinant) < 1e-3);
            CHECK(rate[0] < 0.0);
            CHECK(std::abs(record.stress[0]) < 1e-4 * s0);
        }
        CHECK(deviation(record.stress[2], -pressure) < 1e-5);
    }
}

TEST_CASE("without pressure a die is never met: free sintering, whatever axes it confines") {
    for (const sintering::Axes& confined : {sintering::Axes{true, false, false}, xy, sintering::Axes{true, true, true}}) {
        sintering::ImplicitSintering in_die(random_packing(300, 0.58, 1.0), pressed(0.0, confined)),
            free(random_packing(300, 0.58, 1.0), pressed(0.0, {}));
        while (free.time() < 20.0) {
            const sintering::StepRecord one = in_die.advance(20.0, endless), other = free.advance(20.0, endless);
            CHECK(deviation(one.relative_density, other.relative_density) < 1e-7);
            CHECK(one.converged);
        }
        CHECK(in_die.relative_density() > 0.6);
        CHECK(largest_difference(in_die.state(), free.state()) < 1e-5 * radius);
    }
}

TEST_CASE("under a strong pressure a die is a box of fixed length: the same motion to the last bit") {
    sintering::ImplicitSintering in_die(random_packing(300, 0.58, 1.0), pressed(200e6, xy)),
        fixed(random_packing(300, 0.58, 1.0), pressed(200e6, {}, xy));
    for (int step = 0; step < 8; ++step) {
        const sintering::StepRecord one = in_die.advance(20.0, endless), other = fixed.advance(20.0, endless);
        CHECK(one.stress[0] < 0.0);
        CHECK(one.stress[1] < 0.0);
        CHECK(one.stress == other.stress);
        CHECK(one.relative_density == other.relative_density);
    }
    CHECK(largest_difference(in_die.state(), fixed.state()) == 0.0);
}

TEST_CASE("step by step in a die: never past the wall, never in tension, stress only at the wall, all forces in balance") {
    // Around the pressure at which the walls let go, where one of them may hold and the other not.
    int held = 0, clear = 0;
    for (const double pressure : {10e6, 30e6, 50e6}) {
        CAPTURE(pressure);
        sintering::ImplicitSintering sintering(random_packing(200, 0.58, 1.0), pressed(pressure, xy));
        const double solid = relative_density(sintering.state()) * sintering.state().box.volume();
        while (sintering.time() < 10.0) {
            const Vec3 before = sintering.packing().strain();
            const sintering::StepRecord record = sintering.advance(10.0, endless);
            REQUIRE(record.converged);
            for (int axis = 0; axis < 2; ++axis) {
                CHECK(record.strain[axis] < 1e-12);
                CHECK(record.stress[axis] < 1e-3 * pressure);
                // What is clear of the wall at the end of the step was not pressed by it, but where it left on the way.
                if (record.strain[axis] < before[axis]) CHECK(std::abs(record.stress[axis]) < 1e-3 * pressure);
                (record.stress[axis] < -1e-2 * pressure ? held : clear) += 1;
            }
            CHECK(deviation(record.stress[2], -pressure) < 1e-2);
            CHECK(record.imbalance < 0.1);
        }
        CHECK(deviation(relative_density(sintering.state()) * sintering.state().box.volume(), solid) < 1e-12);
    }
    CHECK(held > 10);
    CHECK(clear > 10);
}

TEST_CASE("a body that has shrunk from its die is pressed against it again and stays at the wall; a checkpoint goes on alike") {
    sintering::ImplicitSintering free(face_centred_cell(0.03), pressed(0.0, xy));
    while (free.time() < 2.0) free.advance(2.0, endless);
    const double gap = free.packing().strain()[0];
    REQUIRE(gap < -1e-3);
    sintering::ImplicitSintering pressing(face_centred_cell(0.03), pressed(100e6, xy)),
        again(face_centred_cell(0.03), pressed(100e6, xy));
    pressing.restore(free.checkpoint());
    double last = gap;
    int steps_at_wall = 0;
    for (int step = 0; step < 40 && steps_at_wall < 3; ++step) {
        const sintering::StepRecord record = pressing.advance(100.0, endless);
        CHECK(record.strain[0] >= last - 1e-12);
        CHECK(record.strain[0] < 1e-12);
        CHECK(std::abs(record.strain[0] - record.strain[1]) < 1e-9);
        if (record.strain[0] > -1e-12) ++steps_at_wall;
        last = record.strain[0];
        if (step == 1) again.restore(pressing.checkpoint());
        if (step > 1) {
            const sintering::StepRecord other = again.advance(100.0, endless);
            CHECK(other.relative_density == record.relative_density);
            CHECK(other.stress == record.stress);
        }
    }
    CHECK(steps_at_wall == 3);
    CHECK(largest_difference(pressing.state(), again.state()) == 0.0);
}

TEST_CASE("the explicit method has the same die") {
    for (const double pressure : {5e6, 100e6}) {
        CAPTURE(pressure);
        const double time = 0.2;
        sintering::ImplicitSintering implicit(face_centred_cell(0.03), pressed(pressure, xy));
        sintering::SinteringSettings wanted = pressed(pressure, xy);
        wanted.mass_scaling = 1e17;
        sintering::ExplicitSintering with_inertia(face_centred_cell(0.03), wanted);
        while (implicit.time() < time) implicit.advance(time, endless);
        while (with_inertia.time() < time) CHECK(with_inertia.advance(time, endless).strain[0] <= 0.0);
        const Vec3 one = implicit.packing().strain(), other = with_inertia.packing().strain();
        CHECK(deviation(other[2], one[2]) < 1e-2);
        CHECK(std::abs(other[0] - one[0]) < 1e-2 * std::abs(one[2]));
        CHECK((pressure > 50e6) == (one[0] == 0.0));
    }
}

TEST_CASE("the active set of a die: what is held, let go and taken hold of again") {
    sintering::Die die(xy, {true, true, true}, sintering::die_gap(Vec3(0.0, -0.01, 0.0)));
    CHECK(die.held() == sintering::Axes{true, false, false});
    CHECK(die.revise(Vec3(0.0, 0.02, -0.1), Vec3(1.0, 0.0, -1.0)));  // x pulls, y would pass the wall
    CHECK(die.held() == sintering::Axes{false, true, false});
    CHECK(die.strain() == Vec3(0.0, std::expm1(0.01), 0.0));
    CHECK(die.revise(Vec3(1e-3, 0.01, -0.1), Vec3(0.0, -1.0, -1.0)));  // x after all
    CHECK(die.held() == sintering::Axes{true, true, false});
    CHECK_FALSE(die.revise(Vec3(0.0, 0.01, -0.1), Vec3(1e-9, -1.0, -1.0)));
    CHECK_FALSE(die.pulls(Vec3(1e-9, -1.0, -1.0)));
    CHECK(die.pulls(Vec3(0.1, -1.0, -1.0)));
    // No contacts reach through along x: nothing presses its wall, which a strain of the whole may still meet.
    sintering::Die loose(xy, {false, true, true}, Vec3::Zero());
    CHECK(loose.held() == sintering::Axes{false, true, false});
    const auto refused = [](const sintering::SinteringSettings& wanted, bool periodic) {
        State state = face_centred_cell(0.03);
        state.box.periodic[0] = periodic;
        sintering::ImplicitSintering{state, wanted};
    };
    CHECK_THROWS_WITH_AS(refused(pressed(0.0, xy, {true, false, false}), true), doctest::Contains("not both"), Error);
    CHECK_THROWS_WITH_AS(refused(pressed(0.0, xy), false), doctest::Contains("no faces for a die along x"), Error);
    CHECK_THROWS_WITH_AS(refused(pressed(1e6, {false, false, true}), true), doctest::Contains("a pressure along"), Error);
}
