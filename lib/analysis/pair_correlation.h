// pair_correlation.h: how often particles are found at a distance from another one.
#pragma once

#include <vector>

#include "core/state.h"

namespace kiln::analysis {

struct PairCorrelation {
    std::vector<double> distance;  // m, middle of each shell
    std::vector<double> g;         // 1 where centres lie at random
    std::size_t centres = 0;       // particles from which distances were taken
};

/// g(r) in `bins` shells up to `range` (m): the number of centres in a shell over that of as many centres without order.
/// A distance at the edge of a shell, to 1e-9, counts in the outer one.
/// Along periodic axes all images count. Along free ones distances are taken from the particles that lie at least `range` inside
/// the outermost centres, so that no shell reaches out of the body, and the mean number of centres per volume is that of their
/// region. (M. P. Allen & D. J. Tildesley, Computer Simulation of Liquids, 2nd ed. 2017, section 8.2.) Throws Error if no particle
/// lies so far inside.
PairCorrelation pair_correlation(const State& state, double range, std::size_t bins);

}  // namespace kiln::analysis
