// sweep.h: the shrinking of overlapping spheres by finite decrements.
#pragma once

#include <span>

#include "bonding/shrink.h"
#include "core/stop.h"

namespace kiln::bonding {

/// The literal sweeps with the decrement dR, m. All pairs of a sweep are found before any radius changes, so their order is of no
/// effect; a particle passes the point of touching by at most one sweep's step.
ShrunkSpheres shrink_by_sweeps(std::span<const double> radius, std::span<const Overlap> overlaps, Sharing sharing, double decrement,
                        const Watch& watch = {});

}  // namespace kiln::bonding
