// bond_law.h: stiffness of a solid bond between two spheres, for the bond laws.
#pragma once

#include <string>

namespace kiln::physics {

/// What is taken as elastic between the two centres.
enum class BondLaw {
    series,  // the bond and the two spheres, each truncated where the bond begins
    solid,   // the same, with the constriction of thin bonds and what all bonds of a sphere share of it; see solid_law.h
    neck,    // the bond alone; spheres are rigid
    centre,  // a cylinder of the bond's radius from centre to centre
};

/// How a bond yields to a transverse force; the law solid has its own answer.
enum class BondShear {
    section,     // shear of the sections alone, k_t = G A / L (Potyondy & Cundall 2004)
    timoshenko,  // shear with Cowper's coefficient, and bending of the bond by the transverse force
};

/// Lengths in m. Zero is allowed for the bond's radius (no stiffness) and for its length (see bond_length_floor).
struct BondGeometry {
    double sphere_radius_1, sphere_radius_2;
    double distance;  // between the centres
    double radius;    // of the bond; more than a sphere's radius counts as that
    double length;    // of the bond, L_b of Eq. 4 of Dosta et al. 2017
    // Part of each sphere's surface under the caps of all its bonds, see cap_share(); may be above 1. For the law solid.
    double coverage_1 = 0.0, coverage_2 = 0.0;
};

/// Springs at the mid-point of the line of centres.
struct BondStiffness {
    double normal;   // N/m
    double shear;    // N/m
    double torsion;  // N m/rad
    double bending;  // N m/rad
};

/// A bond counts as no shorter than this share of its smaller sphere's radius, so that touching spheres stay finite.
inline constexpr double bond_length_floor = 1e-3;

/// Integrals along the bond and whatever part of the spheres the law counts as elastic; x runs from the middle of the bond.
struct BondCompliance {
    double stretching;  // integral of 1/A, 1/m
    double bending;     // integral of 1/I, 1/m3
    double transverse;  // integral of x2/I, 1/m
};

/// Sphere of radius R (m) cut at the distance s from its centre where its section has the radius of the bond, seen from the middle
/// of a bond that begins at `arm` (m) beyond the cut. With the section pi (R2 - t2) at t from the centre, integrated from 0 to s:
///   stretching atanh(s/R)/(pi R), bending (4/pi) [s/(2 R2 Rb2) + atanh(s/R)/(2 R3)]; transverse: the latter's integrand times
///   (s + arm - t)2.
BondCompliance sphere_compliance(double sphere_radius, double bond_radius, double arm);

/// All compliances of a bond under a law other than solid; bond radius > 0.
BondCompliance bond_compliance(BondLaw law, const BondGeometry& geometry);

/// Elastic springs of a bond of Young's modulus E and shear modulus G, Pa:
///   k_n = E / int 1/A,  k_torsion = 2 G / int 1/I,  k_bend = E / int 1/I  (Potyondy & Cundall 2004, with A/L as
///   the inverse integral), and k_t = G / int 1/A, or for Timoshenko's beam 1/k_t = int 1/A / (kappa G) + int x2/I / E
///   with Cowper's (1966) kappa = 6 (1 + nu)/(7 + 6 nu) of the circle. A bond of radius zero has no stiffness. For the law solid
///   see solid_law.h.
BondStiffness bond_stiffness(BondLaw law, BondShear shear, double young_modulus, double shear_modulus,
                             const BondGeometry& geometry);

/// The law's name on the command line and in results.
std::string name_of(BondLaw law);
std::string name_of(BondShear shear);

}  // namespace kiln::physics
