// bond_geometry.h: length, volume and radius of the cylindrical bond between two spheres.
//
// Source: Dosta et al. 2017, "Approximation of mechanical properties of sintered materials with discrete element method",
// section 4. Symbols: L_pp distance of the centres, R1 and R2 radii of the spheres, Rb radius of the bond, L_b its length.
#pragma once

namespace kiln::physics {

/// What of a bond's cylinder counts as its volume.
enum class BondVolume {
    cylinder,       // all of it, pi Rb^2 L_b, although the spheres' caps reach into it
    cap_corrected,  // the cylinder without the two caps: the solid that is not part of a sphere
};

/// Bond length, m: L_b = L_pp - sqrt(R1^2 - Rb^2) - sqrt(R2^2 - Rb^2), Eq. 4; all arguments in m, Rb <= min(R1, R2).
double bond_length(double distance, double radius1, double radius2, double bond_radius);

/// Volume of the cap, m3, that a circle of the given radius cuts from a sphere: pi c^2 (3 R - c)/3 with height c; arguments in m.
double cap_volume(double radius, double circle_radius);

/// Volume of a bond, m3; lengths in m. It grows with Rb, from 0 at Rb = 0, for spheres that do not overlap.
double bond_volume(double distance, double radius1, double radius2, double bond_radius, BondVolume kind);

/// Radius of the bond of the given volume (m3), m: the root of bond_volume(Rb) = volume in [0, min(R1, R2)], or min(R1, R2) for a
/// volume too large to fit. The spheres (lengths in m) do not overlap but for rounding.
double bond_radius(double volume, double distance, double radius1, double radius2, BondVolume kind);

}  // namespace kiln::physics
