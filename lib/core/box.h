// box.h: the orthogonal box of a state, its periodic wrap and its image vectors.
#pragma once

#include <cmath>

#include "core/types.h"

namespace kiln {

struct Box {
    Vec3 origin = Vec3::Zero();   // m
    Vec3 lengths = Vec3::Ones();  // m, edges along x, y, z
    std::array<bool, 3> periodic{true, true, true};

    /// Volume, m3.
    double volume() const { return lengths.prod(); }

    /// Vector (m) that moves a position by whole box lengths.
    Vec3 shift(const Image& image) const {
        return {image[0] * lengths[0], image[1] * lengths[1], image[2] * lengths[2]};
    }

    /// Position (m) moved into the box along the periodic axes; the others are left alone.
    Vec3 wrap(const Vec3& position) const {
        Vec3 inside = position;
        for (int axis = 0; axis < 3; ++axis) {
            if (!periodic[static_cast<std::size_t>(axis)]) continue;
            const double cell = std::floor((position[axis] - origin[axis]) / lengths[axis]);
            inside[axis] -= cell * lengths[axis];
            if (inside[axis] >= origin[axis] + lengths[axis]) inside[axis] = origin[axis];
        }
        return inside;
    }
};

}  // namespace kiln
