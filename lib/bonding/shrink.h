// shrink.h: overlapping spheres shrink until none overlap, and what they lose goes to the bonds between them.
//
// Dosta et al. 2017, Eq. 2-3: in every sweep each overlapping pair takes dR from both its particles and gains the volume they lost.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/stop.h"

namespace kiln::bonding {

/// Two overlapping particles (rows; equal for a particle and its own image) and the distance of their centres, m.
struct Overlap {
    std::int32_t first, second;
    double distance;
};

/// How fast a particle with k overlaps shrinks. Either way the volume it loses is shared equally among them.
enum class Sharing {
    pair,      // k dR a sweep: every pair takes its own dR, as Eq. 2 stands
    particle,  // dR a sweep, however many pairs it has
};

/// A particle stops shrinking at this share of its radius; its partners then give alone.
inline constexpr double smallest_share = 0.01;

struct Shrunk {
    std::vector<double> radius;  // m, of every particle
    std::vector<double> volume;  // m3, given to every overlap
    std::size_t stopped = 0;     // particles that came down to smallest_share
};

/// The limit dR -> 0, exact to rounding: between two separations every radius falls linearly, so an event queue suffices.
/// The watch hears of the fraction of overlaps that are gone.
/// radius: m. Centres must lie further apart than smallest_share of the sum of the radii.
Shrunk shrink_exactly(std::span<const double> radius, std::span<const Overlap> overlaps, Sharing sharing, const Watch& watch = {});

/// The literal sweeps with the decrement dR, m. All pairs of a sweep are found before any radius changes, so their order is of no
/// effect; a particle passes the point of touching by at most one sweep's step.
Shrunk shrink_by_sweeps(std::span<const double> radius, std::span<const Overlap> overlaps, Sharing sharing, double decrement,
                        const Watch& watch = {});

}  // namespace kiln::bonding
