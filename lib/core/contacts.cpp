// contacts.cpp: sums over contacts, and union-find with path halving.
#include "core/contacts.h"

#include <algorithm>
#include <functional>

#include "core/parallel.h"

namespace kiln {

namespace {

constexpr std::size_t chunk_rows = 4096;  // fixed, so that sums do not depend on the number of threads

}  // namespace

ContactStatistics contact_statistics(const Box& box, const Particles& particles, std::span<const Pair> pairs,
                                     std::span<const double> offset) {
    // Summed one after the other, so that pairs apart, which a list may hold or not, change nothing.
    std::vector<double> ratio(pairs.size());
    for_rows(pairs.size(), [&](std::size_t row) {
        const Pair& pair = pairs[row];
        const auto i = static_cast<std::size_t>(pair.i), j = static_cast<std::size_t>(pair.j);
        const double radii = particles.radius[i] + particles.radius[j];
        const double distance = pair_vector(box, particles.position, pair).norm() - (offset.empty() ? 0.0 : offset[row]);
        ratio[row] = contact_overlap(particles.radius[i], particles.radius[j], distance) / radii;
    });
    std::size_t contacts = 0;
    double sum = 0.0;
    for (const double overlap : ratio) {
        if (overlap < 0.0) continue;
        ++contacts;
        sum += overlap;
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
    if (parent_[static_cast<std::size_t>(a)] == parent_[static_cast<std::size_t>(b)]) return;
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
        if (i == j) {
            if (around != 0) percolating_[axis] = true;  // written by several threads, if at all
        } else {
            offset_[static_cast<std::size_t>(j)][axis] = around;
        }
    }
    parent_[static_cast<std::size_t>(j)] = i;
}

std::array<bool, 3> percolating_axes(std::size_t rows, std::span<const Pair> pairs) {
    PeriodicClusters clusters(rows);
    const std::size_t chunks = (rows + chunk_rows - 1) / chunk_rows;
    const auto chunk_of = [](std::int32_t row) { return static_cast<std::size_t>(row) / chunk_rows; };
    // First within each chunk of rows, no row of which leads out of it, then the pairs between them.
    const bool sorted = join_rows(pairs.empty() ? 0 : pairs.size() - 1, true,
                                  [&](std::size_t row) { return pairs[row].i <= pairs[row + 1].i; }, std::logical_and());
    if (sorted)
        for_chunks(chunks, [&](std::size_t chunk) {
            auto at = std::ranges::partition_point(pairs, [&](const Pair& pair) { return chunk_of(pair.i) < chunk; });
            for (; at != pairs.end() && chunk_of(at->i) == chunk; ++at)
                if (chunk_of(at->j) == chunk && at->image == Image{0, 0, 0}) clusters.join(*at);
        });
    for (const Pair& pair : pairs) {
        if (sorted && chunk_of(pair.i) == chunk_of(pair.j) && pair.image == Image{0, 0, 0}) continue;
        clusters.join(pair);
        if (clusters.percolating() == std::array<bool, 3>{true, true, true}) break;
    }
    return clusters.percolating();
}

}  // namespace kiln
