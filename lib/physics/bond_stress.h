// bond_stress.h: greatest stresses in a bond, by beam theory.
//
// Potyondy & Cundall 2004 (Int. J. Rock Mech. Min. Sci. 41, 1329): sigma_max = F_n/A + |M_bending| Rb/I and
// tau_max = |F_shear|/A + |M_torsion| Rb/J, with A = pi Rb^2, I = A Rb^2/4 and J = 2 I. Moments are those at the bond's middle.
#pragma once

#include <numbers>

namespace kiln::physics {

struct BondStress {
    double tensile;  // Pa, at the fibre pulled most; below zero where the whole section is pressed
    double shear;    // Pa, at the edge of the section
};

/// Forces in N, tension positive; moments in N m; radius of the bond in m, greater than zero.
inline BondStress bond_stress(double tension, double shear_force, double bending_moment, double torsion_moment, double radius) {
    const double area = std::numbers::pi * radius * radius;
    return {(tension + 4.0 * bending_moment / radius) / area, (shear_force + 2.0 * torsion_moment / radius) / area};
}

}  // namespace kiln::physics
