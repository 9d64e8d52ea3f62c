// dynamic_bending.h: three-point bending as a motion in time, by the discrete element method.
#pragma once

#include "bending/result.h"
#include "core/stop.h"

namespace kiln::bending {

/// Drives the punch down until the required deflection or force, and up until its force is gone, as many times as there are cycles.
/// Throws Error where the bar cannot be tested (see place_fixture, find_contacts) and where its material has no density.
Result bend_dynamic(State state, const Options& options, const Watch& watch = {});

}  // namespace kiln::bending
