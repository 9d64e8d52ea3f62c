// envelope.h: volume of a body without periodic faces, as a ball that rolls over its outside feels it.
#pragma once

#include "core/state.h"

namespace kiln::analysis {

/// Volume (m3) that a ball of radius `probe` (m) cannot enter from outside: the closing of the union of the particles by that ball,
/// with all hollows that the ball does not reach. It is what an envelope pycnometer measures with its grains, and the alpha shape
/// of H. Edelsbrunner & E. P. Mucke, ACM Trans. Graph. 13 (1994) 43, for spheres instead of points. Bonds lie within the closing of
/// their particles.
///
/// On a grid of 1/6 of the smaller of mean diameter and probe (1/12 for fewer than 100 particles); surfaces are followed between
/// its points. At least one axis of the box must be free: along a periodic one the body goes on as its image. Throws Error if the
/// body does not fit into a grid, for particles too far apart.
double envelope_volume(const State& state, double probe);

}  // namespace kiln::analysis
