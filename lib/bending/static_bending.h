// static_bending.h: three-point bending as a sequence of equilibria.
#pragma once

#include "bending/result.h"
#include "core/stop.h"

namespace kiln::bending {

/// Loads and unloads the bar in equal steps of force. Throws Error where the bar cannot be tested (see place_fixture,
/// find_contacts).
Result bend_static(State state, const Options& options, const Watch& watch = {});

}  // namespace kiln::bending
