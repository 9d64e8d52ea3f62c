// static_test.cpp: force levels of the static test, each solved once, and the cycles made of them.
#include "tools/bend/static_test.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tools/bend/equilibria.h"

namespace kiln::bend {

namespace {

constexpr double deflection_tolerance = 1e-6;
constexpr int most_trials = 12;

/// Equilibrium at the greatest force: the one given, or the one that gives the deflection wanted.
Level peak_level(Equilibria& levels, const Specimen& specimen, const Fixture& fixture, const Options& options, Result& result) {
    if (options.max_force > 0.0) {
        levels.seat(options.max_force);
        return levels.at(options.max_force, result);
    }
    const double wanted = greatest_deflection(specimen, options);
    double force = estimated_stiffness(specimen, fixture) * wanted;
    levels.seat(force);
    Level level = levels.trial(force, result);
    // Secants, at first through the origin. The slope between a trial and an exact equilibrium close to it would be noise.
    double slope = level.point.force / level.point.deflection;
    bool exact = false;
    for (int trial = 0; trial < most_trials; ++trial) {
        const double missing = wanted - level.point.deflection;
        if (exact && std::abs(missing) <= deflection_tolerance * wanted) return level;
        force = level.point.force + slope * missing;
        if (!(force > 0.0)) throw Error("the bar does not bend downwards under the punch, so no force gives the wanted deflection");
        const Level before = level;
        const bool was_exact = std::exchange(exact, std::abs(missing) <= std::sqrt(deflection_tolerance) * wanted);
        level = exact ? levels.at(force, result) : levels.trial(force, result);
        const double covered = level.point.deflection - before.point.deflection;
        if (exact == was_exact && covered != 0.0) slope = (level.point.force - before.point.force) / covered;
    }
    throw Error("no punch force was found that gives the wanted deflection");
}

/// Work of the punch from the first level to the last, J. Travel is a cubic between forces (Hermite), from its values and slopes.
double work(const std::vector<Level>& levels) {
    double sum = levels.back().point.force * levels.back().point.punch - levels.front().point.force * levels.front().point.punch;
    for (std::size_t k = 0; k + 1 < levels.size(); ++k) {
        const Level& a = levels[k];
        const Level& b = levels[k + 1];
        const double step = b.point.force - a.point.force;
        sum -= step * (a.point.punch + b.point.punch) / 2.0 + step * step / 12.0 * (a.compliance - b.compliance);
    }
    return sum;
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

}  // namespace

Result bend_static(State state, const Options& options, const Watch& watch) {
    Result result;
    result.specimen = cut_specimen(std::move(state), options.model);
    result.fixture = place_fixture(result.specimen, options);
    Equilibria equilibria(result.specimen, result.fixture, options.tolerance);
    std::vector<Level> levels{peak_level(equilibria, result.specimen, result.fixture, options, result)};
    result.peak = std::move(equilibria.last());
    result.contacts = static_cast<std::size_t>(std::count_if(result.peak.contact_force.begin(), result.peak.contact_force.end(),
                                                             [](double force) { return force > 0.0; }));
    result.held_span = held_span(result.specimen, find_contacts(result.specimen, result.fixture), result.peak.contact_force);
    result.loads = mechanics::bond_loads(result.specimen.body.network, result.peak.displacement);
    result.closed_gaps = result.peak.closed_gaps;
    const double greatest = levels.back().point.force;
    for (int point = options.points - 1; point > 0; --point) {
        if (!watch(1.0 - static_cast<double>(point) / options.points)) return result;
        levels.push_back(equilibria.at(greatest * point / options.points, result));
    }
    std::reverse(levels.begin(), levels.end());
    const double stored = levels.back().energy - levels.front().energy;
    result.energy_error = std::abs(work(levels) - stored) / stored;
    result.curve = cycled(levels, options.cycles);
    return result;
}

}  // namespace kiln::bend
