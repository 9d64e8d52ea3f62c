// failure.h: three-point bending until the bar fails, bond by bond.
#pragma once

#include "bending/result.h"
#include "core/stop.h"

namespace kiln::bending {

/// Finds the punch force at which the next bond reaches its strength, breaks that bond, and goes on until the force has fallen to
/// the required share of its greatest, or to nothing because the bar is in pieces. The curve holds one point a break. Throws Error
/// where the bar cannot be tested (see place_fixture, find_contacts) and where no bond can break.
Result bend_to_failure(State state, const Options& options, const Watch& watch = {});

}  // namespace kiln::bending
