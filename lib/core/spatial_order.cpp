// spatial_order.cpp: Morton's curve.
#include "core/spatial_order.h"

#include <algorithm>
#include <numeric>

namespace kiln {

namespace {

constexpr std::uint64_t last_cell = (1u << 21) - 1;  // three coordinates of 21 bits fill a key

/// The bits of a cell coordinate, two places apart.
std::uint64_t spread(std::uint64_t bits) {
    std::uint64_t key = 0;
    for (int bit = 0; bit < 21; ++bit) key |= (bits >> bit & 1) << (3 * bit);
    return key;
}

}  // namespace

std::vector<std::int32_t> spatial_order(const Box& box, std::span<const Vec3> position, double cell) {
    Vec3 low = box.origin;
    for (const Vec3& each : position) low = low.cwiseMin(box.wrap(each));
    std::vector<std::uint64_t> key(position.size());
    for (std::size_t row = 0; row < position.size(); ++row) {
        const Vec3 scaled = (box.wrap(position[row]) - low) / cell;
        for (int axis = 0; axis < 3; ++axis)
            key[row] |= spread(std::min(last_cell, static_cast<std::uint64_t>(std::max(0.0, scaled[axis])))) << axis;
    }
    std::vector<std::int32_t> order(position.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
        return key[static_cast<std::size_t>(a)] < key[static_cast<std::size_t>(b)];
    });
    return order;
}

}  // namespace kiln
