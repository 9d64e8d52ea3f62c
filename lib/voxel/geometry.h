// geometry.h: the union of the spheres and bonds of a periodic state as an image of voxels.
#pragma once

#include <array>
#include <span>

#include "core/state.h"
#include "voxel/image.h"

namespace kiln::voxel {

/// Numbers of voxels along the axes of a box so that there are about `voxels` to the given length, m: for each axis the number
/// without prime factors above 5 (quick to transform) that is nearest in ratio, so the edges of a voxel differ by a few percent.
/// Throws Error for more than a million along an axis.
std::array<std::size_t, 3> grid_counts(const Box& box, double length, double voxels);

/// Mean radius of the particles, m.
double mean_radius(const Particles& particles);

/// The image of a state, and what of the box the union of spheres and bonds fills, counted by the middles of the voxels.
struct Raster {
    Image image;
    double union_fraction;
};

/// A voxel is solid if its middle lies in a sphere or in a bond, which is the cylinder of the bond's radius about the line of
/// centres; between the spheres it has the length of Eq. 4, inside them it makes no difference. Works for bonds of any method, and
/// for states without bonds.
///
/// Gaps stay open. Two spheres that touch, or nearly so, part slowly around their neck, and voxels on both sides of a gap thinner
/// than one would share nodes: a second neck, of the grid's making, which is the greater part of the error of voxels (at a
/// relative density of 0.60 it makes the modulus a third too large with 12 voxels a radius). So voxels of the two spheres through
/// which the plane between them passes are void, where they are further from the axis than the radius of the bond and, of spheres
/// that overlap, than the circle from which on the gap is wider than a quarter of that layer: with a quarter, lattices of
/// overlapping spheres have their conductivity and stiffness with the least error. union_fraction counts these voxels.
///
/// phase: of each particle, 1 to 254. A voxel takes that of the particle (of those whose sphere or bond it lies in) for which the
/// square of the distance to the centre less that of the radius is least: in a sphere alone its own, and otherwise the nearer side
/// of the plane in which the two spheres meet. Throws Error where the box is not periodic along all axes.
Raster rasterise(const State& state, const std::array<std::size_t, 3>& count, std::span<const std::uint8_t> phase);

}  // namespace kiln::voxel
