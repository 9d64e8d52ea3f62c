// neighbours.h: the only neighbour search, a hierarchy of periodic cell grids that is O(N) for any mix of sizes.
#pragma once

#include <algorithm>
#include <compare>
#include <span>
#include <vector>

#include "core/box.h"

namespace kiln {

/// Particle j, moved by image, is near particle i. Each pair stands once; i < j, or i == j for a particle near its own image.
struct Pair {
    std::int32_t i, j;
    Image image;

    friend auto operator<=>(const Pair&, const Pair&) = default;
};

/// All pairs, periodic images included, with |x_j + image L - x_i| < reach_i + reach_j.
///
/// position: N centres, m, inside the box or not; reach: N distances > 0, m. Boxes shorter than the reach are searched through as
/// many images as it takes. Sorted by i, then j, then image; the order does not depend on the number of threads.
/// Throws Error where an image index leaves the range of a signed byte.
std::vector<Pair> find_pairs(const Box& box, std::span<const Vec3> position, std::span<const double> reach);

/// Those of these pairs in which one of the particles `of` takes part, rows of position, each once. Made for a few particles: the
/// search of each is its own, whatever the number of the others.
std::vector<Pair> find_pairs(const Box& box, std::span<const Vec3> position, std::span<const double> reach,
                             std::span<const std::int32_t> of);

/// Vector from i to the image of j, m.
inline Vec3 pair_vector(const Box& box, std::span<const Vec3> position, const Pair& pair) {
    return position[static_cast<std::size_t>(pair.j)] + box.shift(pair.image) - position[static_cast<std::size_t>(pair.i)];
}

/// Overlap of two spheres, m, negative for a gap. A gap within the rounding of centres, 1e-9 of the smaller radius, is none:
/// spheres that were placed to touch do.
inline double contact_overlap(double first, double second, double distance) {
    constexpr double touching_gap = 1e-9;
    const double overlap = first + second - distance;
    return overlap < 0.0 && overlap > -touching_gap * std::min(first, second) ? 0.0 : overlap;
}

}  // namespace kiln
