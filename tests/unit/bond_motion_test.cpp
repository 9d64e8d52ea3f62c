// bond_motion_test.cpp: the incremental bond against the springs it stands for, and under rotations that must not load it.
#include "physics/bond_motion.h"

#include <doctest/doctest.h>

#include <cmath>

#include "physics/hertz.h"
#include "tests/physics/relative.h"

using namespace kiln;
using namespace kiln::physics;
using kiln::test::relative;

namespace {

constexpr BondStiffness springs{3.0, 2.0, 0.7, 0.4};

}  // namespace

TEST_CASE("small relative motions load the springs of the bond's middle") {
    const Vec3 vector(2.0, 0.0, 0.0), shift(0.0, 1e-7, -2e-7), turn_1(1e-8, 3e-8, 0.0), turn_2(-2e-8, 1e-8, 5e-8);
    BondHold hold;
    advance_bond(hold, springs, vector, shift, turn_1, turn_2);
    const Vec3 opening = shift + vector.cross((turn_1 + turn_2) / 2.0), turning = turn_2 - turn_1;
    CHECK((hold.shear - springs.shear * Vec3(0.0, opening[1], opening[2])).norm() <= 1e-14 * hold.shear.norm());
    CHECK((hold.moment - Vec3(springs.torsion * turning[0], springs.bending * turning[1], springs.bending * turning[2])).norm() <=
          1e-14 * hold.moment.norm());
}

TEST_CASE("what a bond holds goes along as the pair turns as one body, about any axis and all the way round") {
    for (const Vec3& axis : {Vec3(0.0, 0.0, 1.0), Vec3(1.0, 0.0, 0.0), Vec3(0.6, 0.0, 0.8)}) {
        constexpr int steps = 4000;
        const Vec3 turn = 2.0 * std::acos(-1.0) / steps * axis;
        BondHold hold{Vec3(0.0, 1.0, 0.5), Vec3(0.3, -0.2, 0.7)};
        const BondHold start = hold;
        Vec3 vector(2.0, 0.0, 0.0);
        for (int step = 0; step < steps; ++step) {
            const Vec3 next = turned(vector, turn);
            advance_bond(hold, springs, (vector + next) / 2.0, next - vector, turn, turn);
            vector = next;
        }
        CHECK((hold.shear - start.shear).norm() <= 1e-5);
        CHECK((hold.moment - start.moment).norm() <= 1e-5);
        CHECK(vector.norm() == relative(2.0, 1e-12));
    }
}

TEST_CASE("turning keeps sizes, and turns by the angle to its third order") {
    const Vec3 vector(1.0, 2.0, 3.0), turn(0.1, -0.2, 0.05);
    CHECK(turned(vector, turn).norm() == relative(vector.norm(), 1e-14));
    const Vec3 exact = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * vector;
    CHECK((turned(vector, turn) - exact).norm() <= std::pow(turn.norm(), 3.0) / 12.0 * vector.norm());
}

TEST_CASE("a lengthening far below the rounding of the length keeps its digits") {
    const Vec3 rest(3.0, 4.0, 0.0);
    CHECK(lengthening(rest, Vec3(6.0, 8.0, 0.0)) == relative(10.0, 1e-15));
    CHECK(lengthening(rest, 1e-20 * rest) == relative(5e-20, 1e-14));
}

TEST_CASE("Hertz and Mindlin: overlap inverts force, tangential over normal stiffness is 2 (1 - nu)/(2 - nu)") {
    const double E = 400e9, nu = 0.23, R = 50e-9, h = 1e-10, modulus = contact_modulus(E, nu);
    CHECK(hertz_overlap(modulus, R, hertz_contact(modulus, R, h).force) == relative(h, 1e-13));
    CHECK(mindlin_stiffness(contact_shear_modulus(E, nu), R, h) / hertz_contact(modulus, R, h).stiffness ==
          relative(2.0 * (1.0 - nu) / (2.0 - nu), 1e-13));
    CHECK(in_contact(3.0, 6.0) == 2.0);
    CHECK(mindlin_stiffness(1.0, 1.0, -1.0) == 0.0);
}
