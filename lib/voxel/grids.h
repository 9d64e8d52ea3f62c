// grids.h: the tensor of a state on several grids, each starting from what the one before found.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/state.h"
#include "voxel/homogenisation.h"

namespace kiln::voxel {

/// What the particles of a state are made of: a phase for each, and the medium of each phase.
template <typename Medium>
struct Phases {
    std::vector<std::uint8_t> of_particle;  // 1 to media.size()
    std::vector<Medium> media;
};

/// Elastic phases by the materials of a state. Throws Error for a material without its moduli, or more than 254 of them.
Phases<Solid> elastic_phases(const State& state);

/// The same conductivity, W/(m K), for all particles.
Phases<Conductor> conducting_phases(const State& state, double conductivity);

/// A tensor on one grid.
struct OnGrid {
    std::array<std::size_t, 3> count{};  // voxels along x, y, z
    double voxels = 0.0;                 // a mean radius over the edge of a cube of a voxel's volume
    double union_fraction = 0.0;         // of the box that spheres and bonds fill
    double loose_fraction = 0.0;         // of the box: parts that reach round no axis, and were left out
    Homogenised found;
};

/// The grids for so many voxels a mean radius, coarsest first; see grid_counts(). Throws Error where two of them are one.
std::vector<std::array<std::size_t, 3>> grids_of(const State& state, std::span<const double> voxels);

/// The tensor of a state on each grid. Throws Interrupted, and Error for a solid that does not reach round the box along an axis.
template <typename Medium>
std::vector<OnGrid> on_grids(const State& state, const Phases<Medium>& phases,
                             std::span<const std::array<std::size_t, 3>> grids, double tolerance, const Watch& watch = {});

/// The tensor of an image as it is; voxels is 0.
template <typename Medium>
OnGrid of_image(Image image, const std::vector<Medium>& media, double tolerance, const Watch& watch = {},
                Solutions* solutions = nullptr);

extern template std::vector<OnGrid> on_grids(const State&, const Phases<Solid>&, std::span<const std::array<std::size_t, 3>>,
                                             double, const Watch&);
extern template std::vector<OnGrid> on_grids(const State&, const Phases<Conductor>&, std::span<const std::array<std::size_t, 3>>,
                                             double, const Watch&);
extern template OnGrid of_image(Image, const std::vector<Solid>&, double, const Watch&, Solutions*);
extern template OnGrid of_image(Image, const std::vector<Conductor>&, double, const Watch&, Solutions*);

}  // namespace kiln::voxel
