// node_geometry.h: where the nodes of a matrix are.
#pragma once

#include <cstdint>
#include <vector>

#include "core/types.h"

namespace kiln::linalg {

/// Where the nodes of a matrix are, in units of the length that its rotations are multiplied by.
struct NodeGeometry {
    std::vector<Vec3> position;
    Vec3 period;  // 0 along an axis that is not periodic

    /// From node i to the nearest image of node j.
    Vec3 between(std::int32_t i, std::int32_t j) const;
};

}  // namespace kiln::linalg
