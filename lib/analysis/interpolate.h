// interpolate.h: a state between two states of the same particles.
#pragma once

#include "core/state.h"

namespace kiln::analysis {

/// The state a share (0 to 1) of the way from one to the other: time, temperature, box, positions (the nearer way around through
/// periodic faces), radii, and the sizes of bonds are linear in the share. Everything else, the order of the particles among it, is
/// that of `first`. Particles are matched by id. Throws Error that names the particle or the bond by which the states differ.
State interpolated(const State& first, const State& second, double share);

}  // namespace kiln::analysis
