// node_geometry.cpp: vectors between nodes through periodic faces.
#include "linalg/node_geometry.h"

#include <cmath>

namespace kiln::linalg {

Vec3 NodeGeometry::between(std::int32_t i, std::int32_t j) const {
    Vec3 vector = position[static_cast<std::size_t>(j)] - position[static_cast<std::size_t>(i)];
    for (int axis = 0; axis < 3; ++axis) {
        if (period[axis] > 0.0) vector[axis] -= period[axis] * std::round(vector[axis] / period[axis]);
    }
    return vector;
}

}  // namespace kiln::linalg
