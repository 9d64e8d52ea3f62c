// contacts.cpp: sums over contacts, and union-find with path halving.
#include "core/contacts.h"

#include <algorithm>

namespace kiln {

ContactStatistics contact_statistics(const Box& box, const Particles& particles, std::span<const Pair> pairs,
                                     std::span<const double> offset) {
    std::size_t contacts = 0;
    double sum = 0.0;
    for (std::size_t row = 0; row < pairs.size(); ++row) {
        const Pair& pair = pairs[row];
        const auto i = static_cast<std::size_t>(pair.i), j = static_cast<std::size_t>(pair.j);
        const double radii = particles.radius[i] + particles.radius[j];
        const double distance = pair_vector(box, particles.position, pair).norm() - (offset.empty() ? 0.0 : offset[row]);
        const double overlap = contact_overlap(particles.radius[i], particles.radius[j], distance);
        if (overlap < 0.0) continue;
        ++contacts;
        sum += overlap / radii;
    }
    const auto count = static_cast<double>(contacts);
    return {particles.size() == 0 ? 0.0 : 2.0 * count / static_cast<double>(particles.size()), contacts == 0 ? 0.0 : sum / count};
}

std::int32_t Clusters::root(std::int32_t row) {
    const auto at = [&](std::int32_t index) -> std::int32_t& { return parent_[static_cast<std::size_t>(index)]; };
    while (at(row) != row) row = at(row) = at(at(row));
    return row;
}

void Clusters::join(std::int32_t a, std::int32_t b) {
    const auto [low, high] = std::minmax({root(a), root(b)});
    parent_[static_cast<std::size_t>(high)] = low;
}

std::int32_t PeriodicClusters::root(std::int32_t row, Offset& image) {
    image = {0, 0, 0};
    for (auto at = static_cast<std::size_t>(row); parent_[at] != row; at = static_cast<std::size_t>(row)) {
        const auto above = static_cast<std::size_t>(parent_[at]);
        // Path halving: the row is seen from its grandparent.
        for (std::size_t axis = 0; axis < 3; ++axis) offset_[at][axis] += offset_[above][axis];
        parent_[at] = parent_[above];
        for (std::size_t axis = 0; axis < 3; ++axis) image[axis] += offset_[at][axis];
        row = parent_[at];
    }
    return row;
}

void PeriodicClusters::join(const Pair& pair) {
    Offset to_i{}, to_j{};
    const std::int32_t i = root(pair.i, to_i), j = root(pair.j, to_j);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const int around = to_i[axis] + pair.image[axis] - to_j[axis];  // of j's root seen from i's
        if (i == j)
            percolating_[axis] = percolating_[axis] || around != 0;
        else
            offset_[static_cast<std::size_t>(j)][axis] = around;
    }
    parent_[static_cast<std::size_t>(j)] = i;
}

std::array<bool, 3> percolating_axes(std::size_t rows, std::span<const Pair> pairs) {
    PeriodicClusters clusters(rows);
    for (const Pair& pair : pairs) clusters.join(pair);
    return clusters.percolating();
}

}  // namespace kiln
