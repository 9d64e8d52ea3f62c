// bond_motion.h: a bond between two moving spheres in incremental form: what it holds turns with it and grows with their motion.
//
// Potyondy & Cundall 2004: increments of shear force and moments from the relative motion at the bond's middle. Tension is not
// incremental but k_n times the change of length, so that it keeps no error. What is held is turned, without change of size, as the
// line of centres turns and about that line as the two spheres spin on the average.
#pragma once

#include <Eigen/Geometry>

#include "core/types.h"
#include "physics/bond_law.h"

namespace kiln::physics {

/// On the first sphere.
struct BondHold {
    Vec3 shear = Vec3::Zero();   // N
    Vec3 moment = Vec3::Zero();  // N m, at the bond's middle
};

/// A vector turned by a rotation vector (rad), its size kept to rounding: Cayley's form of the rotation, which differs from the
/// exact one by the cube of the angle.
inline Vec3 turned(const Vec3& vector, const Vec3& turn) {
    const Vec3 half = 0.5 * turn;
    const Vec3 across = half.cross(vector);
    return vector + 2.0 / (1.0 + half.squaredNorm()) * (across + half.cross(across));
}

/// One step. middle: from the first sphere to the second, halfway through the step, m; shift: displacement of the second against
/// the first in the step, m; turn_1, turn_2: their rotations in it, rad.
inline void advance_bond(BondHold& hold, const BondStiffness& k, const Vec3& middle, const Vec3& shift, const Vec3& turn_1,
                         const Vec3& turn_2) {
    const double inverse_square = 1.0 / middle.squaredNorm();
    const Vec3 mean_turn = 0.5 * (turn_1 + turn_2), turning = turn_2 - turn_1;
    const Vec3 opening = shift + middle.cross(mean_turn);
    const Vec3 turn = (middle.cross(shift) + middle.dot(mean_turn) * middle) * inverse_square;
    hold.shear = turned(hold.shear, turn) + k.shear * (opening - opening.dot(middle) * inverse_square * middle);
    hold.moment =
        turned(hold.moment, turn) + k.bending * turning + (k.torsion - k.bending) * turning.dot(middle) * inverse_square * middle;
}

/// Growth of the length of `rest` (m) by `shift` (m) without loss of digits for small shifts, m.
inline double lengthening(const Vec3& rest, const Vec3& shift) {
    return shift.dot(2.0 * rest + shift) / (rest.norm() + (rest + shift).norm());
}

}  // namespace kiln::physics
