// solid_law.h: stiffness of a neck in a packing, as the solid of spheres and necks has it.
//
// Early necks are constrictions: the half-spaces around them yield, as under a punch. Late ones share the bulk of their spheres
// with the other necks. Of both sides i of a neck of radius a and length L, with x = a/R_i, s = sqrt(R_i^2 - a^2), and A, I,
// J = 2 I of the neck's circle:
//
//   1/k_n       = 0.7 L/(E A) + sum [P_n (1 - x)^(9/4) + 0.6 W_i S_n]
//   1/k_t       = 0.7 (L/(G A) + L^3/(12 E I)) + sum [P_t (1 - x)^(9/4) + W_i (2 (1 + nu) S_n + B)]
//   1/k_torsion = 0.7 L/(G J) + sum [P_q (1 - x)^(5/4) + 0.6 W_i (1 + nu) S_b]
//   1/k_bend    = 0.7 L/(E I) + sum [P_b (1 - x)^(5/4) + 0.6 W_i S_b]
//
// P are half-spaces under the rigid punch of radius a (Johnson, Contact Mechanics, 1985, ch. 3; Mindlin 1949; Reissner & Sagoci
// 1944):
//   P_n = (1 - nu^2)/(2 E a), P_t = (2 - nu)(1 + nu)/(4 E a), P_q = 3 (1 + nu)/(8 E a^3), P_b = 3 (1 - nu^2)/(4 E a^3)
// S_n, S_b, B are sections of the sphere up to the neck, one behind the other: the stretching, bending and transverse of
// sphere_compliance() over E, the last from the neck's middle. W_i = max(1, O_i)^0.35 with the coverage O_i of the sphere.
//
// Where the numbers are from: 9/4 and 5/4 from finite elements of one neck (axisymmetric, all four modes, within 6 % for x from 0.2
// to 0.95); 0.7 (other necks run into a neck's cylinder), 0.6 and 0.35 from voxel solutions of packings.
// docs/mechanics.md has the errors. Springs between pairs exaggerate anisotropy: moduli of lattices along their axes may be off by
// half, or twice what they are.
#pragma once

#include "physics/bond_law.h"

namespace kiln::physics {

/// Share of a sphere's surface under the cap that a bond cuts off, (1 - s/R)/2; lengths in m. Their sum over the bonds of a sphere
/// is its coverage.
double cap_share(double sphere_radius, double bond_radius);

/// What Poisson's ratio of a body of such necks has from that of its solid beyond what the springs say: a particle pressed from
/// one side pushes on all its necks, and springs between pairs know nothing of it. (f - 0.55)/0.45 (nu - 0.23) for a solid of
/// ratio nu that fills the fraction f, nothing below 0.55. By voxel solutions of two packings with nu = 0.15 and 0.30; the springs
/// alone meet those at 0.23. docs/mechanics.md has the errors.
double poisson_shift(double poisson_ratio, double solid_fraction);

/// Springs of the law above; E and G in Pa, bond radius > 0. Finite and positive for any radius up to that of the smaller sphere,
/// more counts as that, and for any length: less than bond_length_floor a^2/R counts as that.
BondStiffness solid_stiffness(double young_modulus, double shear_modulus, const BondGeometry& geometry);

}  // namespace kiln::physics
