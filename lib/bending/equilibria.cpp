// equilibria.cpp: the contact problem of a bar, and what is read from its equilibria.
#include "bending/equilibria.h"

#include <algorithm>

namespace kiln::bending {

namespace {

constexpr double seating_share = 1e-9;    // of the greatest force
constexpr double loose_tolerance = 1e-4;  // of equilibria that only tell how stiff the bar is
constexpr double guess_tolerance = 1e-2;  // of one whose force may be several times too large
constexpr double watched_gap = 0.2;       // of the mean radius: wider gaps do not close under small deflections

/// Pairs without a bond so near that they may come to touch in the test.
std::vector<mechanics::PairContact> pairs_that_may_touch(const Specimen& specimen) {
    const mechanics::BondNetwork& network = specimen.body.network;
    return mechanics::near_pairs(network, mechanics::elastic_spheres(specimen.state, specimen.body),
                                 mechanics::Vector(network.nodes(), mechanics::Vec6::Zero()),
                                 watched_gap * network.rotation_length);
}

}  // namespace

double work_of_punch(std::span<const Level> levels) {
    double sum = levels.back().point.force * levels.back().point.punch - levels.front().point.force * levels.front().point.punch;
    for (std::size_t k = 0; k + 1 < levels.size(); ++k) {
        const Level& a = levels[k];
        const Level& b = levels[k + 1];
        const double step = b.point.force - a.point.force;
        sum -= step * (a.point.punch + b.point.punch) / 2.0 + step * step / 12.0 * (a.compliance - b.compliance);
    }
    return sum;
}

WorkOfStep work_of_step(const Level& from, const Level& to) {
    const double travel = to.point.punch - from.point.punch, force = to.point.force - from.point.force;
    const double mean = 0.5 * (from.point.force + to.point.force) * travel;
    const auto stiffness = [](const Level& level) { return level.compliance > 0.0 ? 1.0 / level.compliance : 0.0; };
    const double by_force = mean - force * force / 12.0 * (from.compliance - to.compliance);
    const double by_travel = mean + travel * travel / 12.0 * (stiffness(from) - stiffness(to));
    const double range = 0.5 * std::abs(force * travel);  // about the mean, whatever the curve, if it is monotone
    const auto possible = [&](double work) { return std::abs(work - mean) <= range; };
    if (possible(by_force) && possible(by_travel)) return {by_force, std::abs(by_force - by_travel)};
    return {mean, range};
}

Equilibria::Equilibria(const Specimen& specimen, const Fixture& fixture, const Options& options,
                       const StopRequest& stop)
    : network_(specimen.body.network),
      tooling_(find_contacts(specimen, fixture)),
      solver_(specimen.body.network, mechanics::Ground::displacement_and_rotation, stop, options.linear_solver),
      problem_(specimen.body.network, solver_, tooling_.contacts, pairs_that_may_touch(specimen), options.friction,
               seating_share * expected_force(specimen, fixture, options), options.tolerance),
      gauge_(specimen, fixture),
      tolerance_(options.tolerance) {}

double Equilibria::trial_tolerance() const { return std::max(loose_tolerance, tolerance_); }

Level Equilibria::trial(double force, Result& result) { return level_of(problem_.solve(force, trial_tolerance()), result); }

Level Equilibria::guess(double force, Result& result) {
    return level_of(problem_.solve(force, std::max(guess_tolerance, tolerance_)), result);
}

Level Equilibria::relaxed(Result& result) { return level_of(problem_.relax(last_.punch_force, trial_tolerance()), result); }

Level Equilibria::at(double force, Result& result) {
    const Level level = level_of(problem_.solve(force, tolerance_), result);
    result.residual = std::max(result.residual, last_.residual);
    result.converged = result.converged && last_.converged;
    return level;
}

Level Equilibria::level_of(mechanics::Equilibrium equilibrium, Result& result) {
    last_ = std::move(equilibrium);
    result.iterations += last_.iterations;
    result.tilt = std::max(result.tilt, mean_turn(network_, last_.displacement));
    return {{gauge_.read(last_.displacement), last_.punch - problem_.seat(), last_.punch_force},
            last_.punch_compliance,
            last_.bond_energy + last_.contact_energy,
            last_.friction_loss};
}

}  // namespace kiln::bending
