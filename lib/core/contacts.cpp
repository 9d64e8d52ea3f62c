// contacts.cpp: sums over contacts, and union-find with path halving.
#include "core/contacts.h"

#include <algorithm>

namespace kiln {

ContactStatistics contact_statistics(const Box& box, const Particles& particles, std::span<const Pair> pairs) {
    std::size_t contacts = 0;
    double sum = 0.0;
    for (const Pair& pair : pairs) {
        const double radii = particles.radius[static_cast<std::size_t>(pair.i)] + particles.radius[static_cast<std::size_t>(pair.j)];
        const double overlap = radii - pair_vector(box, particles.position, pair).norm();
        if (overlap < 0.0) continue;
        ++contacts;
        sum += overlap / radii;
    }
    const double count = static_cast<double>(contacts);
    return {particles.size() == 0 ? 0.0 : 2.0 * count / static_cast<double>(particles.size()), contacts == 0 ? 0.0 : sum / count};
}

std::int32_t Clusters::root(std::int32_t row) {
    const auto at = [&](std::int32_t index) -> std::int32_t& { return parent_[static_cast<std::size_t>(index)]; };
    while (at(row) != row) row = at(row) = at(at(row));
    return row;
}

std::array<bool, 3> percolating_axes(std::size_t rows, std::span<const Pair> pairs) {
    // Each particle knows the image it has seen from its parent. A pair that closes a ring must bring back the same image.
    using Offset = std::array<int, 3>;
    std::vector<std::int32_t> parent(rows);
    std::iota(parent.begin(), parent.end(), 0);
    std::vector<Offset> offset(rows, Offset{0, 0, 0});
    const auto find = [&](std::int32_t row, Offset& sum) {
        sum = {0, 0, 0};
        for (auto at = static_cast<std::size_t>(row); parent[at] != row; at = static_cast<std::size_t>(row)) {
            const auto above = static_cast<std::size_t>(parent[at]);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                sum[axis] += offset[at][axis];
                offset[at][axis] += offset[above][axis];  // path halving: from now on seen from the grandparent
            }
            for (std::size_t axis = 0; axis < 3; ++axis) sum[axis] += offset[above][axis];
            parent[at] = parent[above];
            row = parent[at];
        }
        return row;
    };
    std::array<bool, 3> percolates{false, false, false};
    for (const Pair& pair : pairs) {
        Offset to_i{}, to_j{};
        const std::int32_t i = find(pair.i, to_i), j = find(pair.j, to_j);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const int around = to_i[axis] + pair.image[axis] - to_j[axis];  // of j's root seen from i's
            if (i == j)
                percolates[axis] = percolates[axis] || around != 0;
            else
                offset[static_cast<std::size_t>(j)][axis] = around;
        }
        parent[static_cast<std::size_t>(j)] = i;
    }
    return percolates;
}

void Clusters::join(std::int32_t a, std::int32_t b) {
    const auto [low, high] = std::minmax({root(a), root(b)});
    parent_[static_cast<std::size_t>(high)] = low;
}

}  // namespace kiln
