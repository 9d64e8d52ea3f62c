// image.h: a periodic body as an image of voxels, each void or of one of some materials.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/types.h"

namespace kiln::voxel {

/// Voxels of a periodic box, x running fastest, then y, then z. A voxel is void (0) or of material number `phase - 1`.
struct Image {
    std::array<std::size_t, 3> count{};  // voxels along x, y, z
    Vec3 edges = Vec3::Ones();           // m, of a voxel
    std::vector<std::uint8_t> phase;

    std::size_t voxels() const { return count[0] * count[1] * count[2]; }
    /// Fraction of the voxels that are not void.
    double solid_fraction() const;
};

/// What of an image's solid reaches round the periodic box.
struct Percolation {
    std::array<bool, 3> along{};  // x, y, z: some component, voxel to voxel through their faces, meets its own image one box on
    std::size_t loose = 0;        // voxels of components that reach round no axis
};

/// Finds the solid's components and makes void those that reach round no axis: they carry nothing, and are held by nothing.
Percolation remove_loose(Image& image);

}  // namespace kiln::voxel
