// connectivity.h: which particles hang together through bonds.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/grouping.h"

namespace kiln::mechanics {

/// Particles connected by bonds, piece by piece. Within a piece they stand breadth first from the piece's first particle in
/// `start_order`, so that neighbours stand near each other.
struct Components {
    std::vector<std::int32_t> particle;  // every particle once
    std::vector<std::size_t> start;      // pieces + 1: where each piece begins in `particle`

    std::size_t size() const { return start.size() - 1; }
    std::size_t size(std::size_t piece) const { return start[piece + 1] - start[piece]; }
    std::span<const std::int32_t> of(std::size_t piece) const { return std::span(particle).subspan(start[piece], size(piece)); }
    /// The piece with the most particles; the first of equals.
    std::size_t largest() const;
};

/// start_order: all particles, in the order in which they may begin a piece.
Components find_components(std::span<const std::int32_t> start_order, std::span<const std::array<std::int32_t, 2>> pairs);

/// For each of `count` particles the bonds at it, ascending. A bond of a particle with its own image stands once.
Grouping<std::int32_t> find_incidence(std::size_t count, std::span<const std::array<std::int32_t, 2>> pairs);

}  // namespace kiln::mechanics
