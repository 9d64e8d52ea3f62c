// voxel_image.h: images of voxels as NumPy's .npy files and as VTK image data (.vti).
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/types.h"

namespace kiln::io {

/// A three-dimensional array of bytes; the first index runs fastest in `values`.
struct ByteImage {
    std::array<std::size_t, 3> shape{};
    std::vector<std::uint8_t> values;
};

/// Reads a .npy file (format 1 to 3) of three dimensions, of bytes or booleans (u1, i1, b1), whose values are all 0 or 1; either
/// order of storage. Throws Error that names the file and what was found.
ByteImage read_npy_mask(const std::string& file);

/// The bytes of a .npy file (format 1.0, u1), array[i, j, k] with i along the first axis.
std::string npy_bytes(const ByteImage& image);

/// The bytes of a VTK XML image file: cells of the given edges from the origin on, m, with the values as the cell array `name`.
std::string vti_bytes(const ByteImage& image, const Vec3& origin, const Vec3& edges, const std::string& name);

}  // namespace kiln::io
