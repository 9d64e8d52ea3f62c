// connectivity.cpp: breadth-first search through the bonds.
#include "mechanics/connectivity.h"

#include <algorithm>

namespace kiln::mechanics {

std::size_t Components::largest() const {
    std::size_t best = 0;
    for (std::size_t piece = 1; piece < size(); ++piece) {
        if (size(piece) > size(best)) best = piece;
    }
    return best;
}

Grouping<std::int32_t> find_incidence(std::size_t count, std::span<const std::array<std::int32_t, 2>> pairs) {
    return group_by<std::int32_t>(count, [&](const auto& visit) {
        for (std::size_t bond = 0; bond < pairs.size(); ++bond) {
            const auto [i, j] = pairs[bond];
            visit(static_cast<std::size_t>(i), static_cast<std::int32_t>(bond));
            if (j != i) visit(static_cast<std::size_t>(j), static_cast<std::int32_t>(bond));
        }
    });
}

Components find_components(std::span<const std::int32_t> start_order, std::span<const std::array<std::int32_t, 2>> pairs) {
    const Grouping<std::int32_t> incidence = find_incidence(start_order.size(), pairs);
    Components pieces;
    pieces.start.push_back(0);
    pieces.particle.reserve(start_order.size());
    std::vector<bool> reached(start_order.size(), false);
    const auto reach = [&](std::int32_t particle) {
        if (reached[static_cast<std::size_t>(particle)]) return;
        reached[static_cast<std::size_t>(particle)] = true;
        pieces.particle.push_back(particle);
    };
    for (const std::int32_t first : start_order) {
        if (reached[static_cast<std::size_t>(first)]) continue;
        reach(first);
        for (std::size_t next = pieces.start.back(); next < pieces.particle.size(); ++next) {
            const auto i = static_cast<std::size_t>(pieces.particle[next]);
            for (const std::int32_t bond : incidence.of(i)) {
                const auto& pair = pairs[static_cast<std::size_t>(bond)];
                reach(pair[0]);
                reach(pair[1]);
            }
        }
        pieces.start.push_back(pieces.particle.size());
    }
    return pieces;
}

}  // namespace kiln::mechanics
