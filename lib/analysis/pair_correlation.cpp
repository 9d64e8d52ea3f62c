// pair_correlation.cpp: pairs counted by distance.
#include "analysis/pair_correlation.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/neighbours.h"

namespace kiln::analysis {

namespace {

// A distance so little short of a shell's edge counts as on it, in the outer shell: touching spheres of one size lie on one, and
// rounding is not to choose.
constexpr double at_edge = 1e-9;  // relative

/// True for the particles from which distances are taken; volume becomes that of the region in which they lie.
std::vector<char> inner_particles(const State& state, double range, double& volume) {
    const std::vector<Vec3>& position = state.particles.position;
    std::vector<char> inner(position.size(), 1);
    volume = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
        if (state.box.periodic[static_cast<std::size_t>(axis)]) {
            volume *= state.box.lengths[axis];
            continue;
        }
        const auto along = [axis](const Vec3& place) { return place[axis]; };
        const auto [low, high] = std::ranges::minmax(position, {}, along);
        const double lower = low[axis] + range, upper = high[axis] - range;
        volume *= std::max(0.0, upper - lower);
        for (std::size_t row = 0; row < position.size(); ++row)
            inner[row] = inner[row] && position[row][axis] >= lower && position[row][axis] <= upper;
    }
    return inner;
}

}  // namespace

PairCorrelation pair_correlation(const State& state, double range, std::size_t bins) {
    double volume = 1.0;
    const std::vector<char> inner = inner_particles(state, range, volume);
    PairCorrelation result;
    result.centres = static_cast<std::size_t>(std::ranges::count(inner, 1));
    if (result.centres == 0 || !(volume > 0.0))
        throw Error("no particle lies as far inside the body as the range of the pair correlation; give a shorter --range");
    std::vector<double> counts(bins);
    const std::vector<double> reach(state.particles.size(), 0.5 * range);
    const double width = range / static_cast<double>(bins);
    for (const Pair& pair : find_pairs(state.box, state.particles.position, reach)) {
        const double distance = pair_vector(state.box, state.particles.position, pair).norm();
        const int ends = inner[static_cast<std::size_t>(pair.i)] + inner[static_cast<std::size_t>(pair.j)];
        const auto bin = static_cast<std::size_t>(distance / width * (1.0 + at_edge));
        if (bin < bins) counts[bin] += ends;
    }
    const auto centres = static_cast<double>(result.centres);
    for (std::size_t bin = 0; bin < bins; ++bin) {
        const double inside = static_cast<double>(bin) * width, outside = inside + width;
        const double shell = 4.0 / 3.0 * std::numbers::pi * (outside * outside * outside - inside * inside * inside);
        result.distance.push_back(0.5 * (inside + outside));
        result.g.push_back(counts[bin] / (centres * (centres / volume) * shell));
    }
    return result;
}

}  // namespace kiln::analysis
