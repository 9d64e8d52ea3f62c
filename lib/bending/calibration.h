// calibration.h: the strength of bonds with which a bar breaks as one did that was measured.
#pragma once

#include "bending/result.h"
#include "core/stop.h"

namespace kiln::bending {

/// Tests to failure until the bending strength of the bar is options.calibrate_to (Pa) within 0.2 %: the last of them, whose
/// calibration says the tensile strength of the bonds and the number of tests. An elastic bar scales: bonds twice as strong break
/// under twice the force, but for its contacts, which stiffen under load. Where they make the strength leap past the one asked for
/// the result has not converged. Throws Error as bend_to_failure does.
Result bend_calibrated(State state, const Options& options, const Watch& watch = {});

}  // namespace kiln::bending
