// static_bending.cpp: force levels of the static test and the cycles made of them; with friction, the way from one to the next.
#include "bending/static_bending.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bending/equilibria.h"

namespace kiln::bending {

namespace {

constexpr double deflection_tolerance = 1e-6;
constexpr int max_trials = 12;

/// What an equilibrium is for: the first guess of a force, one near the force sought, or the curve.
enum class Purpose { guess, trial, curve };

/// The equilibrium under a force that has risen from nothing: at once if the bar is elastic, in the curve's steps if there is
/// friction.
Level loaded(Equilibria& levels, double force, Purpose purpose, const Options& options, Result& result) {
    const auto solved = [&](double share) {
        if (purpose == Purpose::curve) return levels.at(share * force, result);
        return purpose == Purpose::trial ? levels.trial(share * force, result) : levels.guess(share * force, result);
    };
    if (options.friction == 0.0) return solved(1.0);
    levels.release();
    for (int point = 1; point < options.points; ++point) {
        solved(static_cast<double>(point) / options.points);
        levels.keep();
    }
    return solved(1.0);
}

/// Equilibrium at the greatest force: the one given, or the one that gives the deflection required.
Level peak_level(Equilibria& levels, const Options& options, Result& result) {
    if (options.max_force > 0.0) return loaded(levels, options.max_force, Purpose::curve, options, result);
    const double required = max_deflection_of(result.specimen, options);
    double force = expected_force(result.specimen, result.fixture, options);
    Level level = loaded(levels, force, Purpose::guess, options, result);
    // Secants, at first through the origin. The slope between a trial and an exact equilibrium close to it would be noise.
    double slope = level.point.force / level.point.deflection;
    bool exact = false;
    for (int trial = 0; trial < max_trials; ++trial) {
        const double missing = required - level.point.deflection;
        if (exact && std::abs(missing) <= deflection_tolerance * required) return level;
        force = level.point.force + slope * missing;
        if (!(force > 0.0))
            throw Error("the bar does not bend downwards under the punch, so no force gives the required deflection");
        const Level before = level;
        const bool was_exact = std::exchange(exact, std::abs(missing) <= std::sqrt(deflection_tolerance) * required);
        level = loaded(levels, force, exact ? Purpose::curve : Purpose::trial, options, result);
        const double covered = level.point.deflection - before.point.deflection;
        if (exact == was_exact && covered != 0.0) slope = (level.point.force - before.point.force) / covered;
    }
    throw Error("no punch force was found that gives the required deflection");
}

/// Greatest gap between the work of the punch and the energy stored and lost, from the first level to each, over the most stored.
double energy_gap(const std::vector<Level>& levels) {
    double gap = 0.0, stored = 0.0;
    for (std::size_t k = 1; k < levels.size(); ++k) {
        const double gained = levels[k].energy - levels[0].energy, lost = levels[k].lost - levels[0].lost;
        gap = std::max(gap, std::abs(work_of_punch(std::span(levels).first(k + 1)) - gained - lost));
        stored = std::max(stored, gained);
    }
    return gap / stored;
}

/// The curve of all cycles: elastic, so that unloading retraces loading.
std::vector<Point> cycled(const std::vector<Level>& levels, int cycles) {
    std::vector<Point> curve{{0.0, 0.0, 0.0}};
    for (int cycle = 0; cycle < cycles; ++cycle) {
        for (const Level& level : levels) curve.push_back(level.point);
        for (std::size_t k = levels.size() - 1; k > 0; --k) curve.push_back(levels[k - 1].point);
        curve.push_back({0.0, 0.0, 0.0});
    }
    return curve;
}

/// All cycles of an elastic bar, from the peak down: each level is solved once.
void cycle_elastic(Equilibria& equilibria, const Level& peak, const Options& options, const Watch& watch, Result& result) {
    std::vector<Level> levels{peak};
    for (int point = options.points - 1; point > 0; --point) {
        watch.at(1.0 - static_cast<double>(point) / options.points);
        levels.push_back(equilibria.at(peak.point.force * point / options.points, result));
    }
    std::reverse(levels.begin(), levels.end());
    result.energy_error = energy_gap(levels);
    result.curve = cycled(levels, options.cycles);
}

/// All cycles of a bar with friction, level by level.
void cycle_with_friction(Equilibria& equilibria, const Level& peak, const Options& options, const Watch& watch, Result& result) {
    equilibria.release();
    const double before = equilibria.friction_loss();
    for (int cycle = 0; cycle < options.cycles; ++cycle) {
        std::vector<Level> levels;
        for (int step = 1; step < 2 * options.points; ++step) {
            watch.at((cycle + 0.5 * step / options.points) / options.cycles);
            const int point = std::min(step, 2 * options.points - step);
            levels.push_back(equilibria.at(peak.point.force * point / options.points, result));
            equilibria.keep();
            result.curve.push_back(levels.back().point);
        }
        result.curve.push_back({0.0, 0.0, 0.0});
        equilibria.release();
        result.energy_error = std::max(result.energy_error, energy_gap(levels));
    }
    result.friction_loss = equilibria.friction_loss() - before;
}

}  // namespace

Result bend_static(State state, const Options& options, const Watch& watch) {
    Result result = prepare(std::move(state), options);
    Equilibria equilibria(result.specimen, result.fixture, options, watch.stop);
    const Level peak = peak_level(equilibria, options, result);
    result.peak = std::move(equilibria.last());
    result.loads = mechanics::bond_loads(result.specimen.body.network, result.peak.displacement);
    read_contacts(result, equilibria.tooling(), result.peak);
    const auto cycle = options.friction > 0.0 ? cycle_with_friction : cycle_elastic;
    cycle(equilibria, peak, options, watch, result);
    add_warnings(result, options);
    return result;
}

}  // namespace kiln::bending
