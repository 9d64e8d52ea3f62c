// conduction.h: conduction of heat (or current) through the necks of a packing of solid particles.
//
// A neck of radius a between two spheres is a constriction. From finite elements of a chain of truncated spheres, x = a/R, the
// conductance between the centres of equal spheres is 2 k a g(x), g = (1 - 0.678 x + 1.048 x^2 - 0.602 x^3)/sqrt(1 - x^2), within
// 0.9 %: 2 k a of Maxwell's slot for x -> 0, the slab for x -> 1. One side is half of that, with half of the neck's cylinder behind
// it.
//
// In a packing the necks of a particle share its bulk. So the part of a side that even a uniform flow would need, l^2/(k V_h) with
// its length l and its volume V_h in the chain, is taken out, and the bulk of the particle of volume V takes its place:
//   R_side = 1/(4 k a g) + L/(2 k pi a^2) - l^2/(k V_h) + 0.94 max(1, m)^(3/4) 2 l^2/(k V)
//   m = n.M.n/2,  M = sum of n n^T over the directions n of the particle's necks
// m is 1 in a chain and in a simple cubic lattice, 4/3 in BCC, 2 in FCC; a uniform field in the particle would have m itself. 0.94
// and 3/4 are fitted to voxel solutions of packings and cubic lattices; docs/mechanics.md has the errors.
#pragma once

namespace kiln::physics {

/// From a sphere's centre to the middle of a neck, alone in its sphere.
struct NeckSide {
    double length;        // m
    double constriction;  // K/W, its resistance less that of a uniform flow; above zero
};

/// conductivity: W/(m K), of the solid. Lengths in m: a neck radius above that of the sphere counts as that; it is above zero.
NeckSide neck_side(double conductivity, double sphere_radius, double neck_radius, double neck_length);

/// Resistance of a particle's bulk to the flow through one of its necks, K/W: length (m) as above, volume of the particle (m3), and
/// alignment of its necks, n.M.n/2.
double bulk_resistance(double conductivity, double length, double volume, double alignment);

/// Upper bound of the conductivity of an isotropic body of a solid that fills a fraction of the volume, pores not conducting, over
/// that of the solid: 2 f/(3 - f) (Hashin & Shtrikman 1962).
double conductivity_bound(double solid_fraction);

}  // namespace kiln::physics
