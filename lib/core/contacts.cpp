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

void Clusters::join(std::int32_t a, std::int32_t b) {
    const auto [low, high] = std::minmax({root(a), root(b)});
    parent_[static_cast<std::size_t>(high)] = low;
}

}  // namespace kiln
