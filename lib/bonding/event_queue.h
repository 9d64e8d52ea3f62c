// event_queue.h: the exact shrinking of overlapping spheres.
#pragma once

#include <span>

#include "bonding/shrink.h"
#include "core/stop.h"

namespace kiln::bonding {

/// The limit dR -> 0, exact to rounding: between two separations every radius falls linearly, so an event queue suffices.
/// The watch hears of the fraction of overlaps that are gone.
/// radius: m. Centres must lie further apart than min_share of the sum of the radii.
ShrunkSpheres shrink_exactly(std::span<const double> radius, std::span<const Overlap> overlaps, Sharing sharing,
                             const Watch& watch = {});

}  // namespace kiln::bonding
