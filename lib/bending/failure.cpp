// failure.cpp: the sequence of breaking bonds.
#include "bending/failure.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "mechanics/connectivity.h"
#include "bending/equilibria.h"

namespace kiln::bending {

namespace {

/// Of its stiffness that a broken bond keeps, so that a particle that hangs on nothing else stays in its place.
constexpr double remnant = 1e-6;
constexpr double strength_tolerance = 1e-3;  // of the stress at which a bond breaks
constexpr int max_trials = 100;
constexpr double narrowest = 1e-12;        // bracket of the force at which a bond breaks, over that force
constexpr double work_tolerance = 2e-5;    // of the work between two breaks, over the most energy that was stored
constexpr double tenth = 0.1;
constexpr int max_halvings = 200;         // of the steps of force between two breaks
constexpr std::size_t max_breaks = 100000;

struct Weakest {
    std::size_t bond = 0;
    double ratio = 0.0;  // of stress to strength
};

/// The bond nearest to its strength; of equals the first.
Weakest find_weakest(const mechanics::BondNetwork& network, const std::vector<mechanics::BondLoad>& loads,
                     const std::vector<std::int32_t>& broken, const Options& options) {
    Weakest weakest;
    for (std::size_t bond = 0; bond < network.bonds(); ++bond) {
        if (broken[bond] > 0) continue;
        const physics::BondStress stress = mechanics::stress_of(network, bond, loads[bond]);
        double ratio = 0.0;
        if (options.tensile_strength > 0.0) ratio = stress.tensile / options.tensile_strength;
        if (options.shear_strength > 0.0) ratio = std::max(ratio, stress.shear / options.shear_strength);
        if (ratio > weakest.ratio) weakest = {bond, ratio};
    }
    return weakest;
}

/// Between two forces, N: halfway, but down by tenths to a force that is next to nothing.
double middle_force(double one, double other) {
    const double low = std::min(one, other), high = std::max(one, other);
    return low < 0.5 * tenth * high ? tenth * high : 0.5 * (low + high);
}

/// A bar that loses its bonds one after the other.
class Failure {
   public:
    Failure(Result& result, const Options& options, const StopRequest& stop)
        : result_(result),
          options_(options),
          spheres_(mechanics::elastic_spheres(result.specimen.state, result.specimen.body)),
          equilibria_(result.specimen, result.fixture, options, stop),
          force_(expected_force(result.specimen, result.fixture, options)) {
        result_.broken.assign(result.specimen.body.network.bonds(), 0);
    }

    /// False once the force has fallen far enough.
    bool next() {
        const Weakest weakest = load();
        account();
        if (level_.point.force <= options_.until * result_.peak_force) return false;
        if (++result_.breaks == max_breaks)
            throw Error("the bar did not fail although " + std::to_string(max_breaks) + " bonds broke");
        crack(weakest.bond);
        if (holds()) {
            relax();
            return true;
        }
        result_.curve.push_back({level_.point.deflection, level_.point.punch, 0.0});
        result_.failure.dissipated += std::exchange(result_.failure.stored, 0.0);
        return false;
    }

    /// How far the force has fallen from its largest towards where the test ends, at most so far: nothing tells how long it grows.
    double progress() {
        const double fallen = (1.0 - level_.point.force / result_.peak_force) / (1.0 - options_.until);
        progress_ = std::max(progress_, std::min(fallen, 1.0));
        return progress_;
    }

    mechanics::Equilibrium& last() { return equilibria_.last(); }

    /// Gap between the work of the punch and all energy, over the most that was stored.
    double energy_gap() const {
        const FailureEnergy& energy = result_.failure;
        return std::abs(energy.work - energy.stored - energy.dissipated) / max_stored_;
    }

   private:
    /// The equilibrium in which the weakest bond has just reached its strength. Stresses grow nearly as the force, or in leaps
    /// where the bar comes to rest on other particles: as soon as there is a force on either side, the search stays between them.
    Weakest load() {
        struct Side {
            double force = 0.0, excess = 0.0;  // N; ratio - 1, halved whenever the other side is moved again (Illinois)
        } below, above;
        for (int trial = 0; trial < max_trials; ++trial) {
            const Weakest weakest = try_force();
            if (!(weakest.ratio > 0.0)) throw Error("no bond of the bar is stressed towards the strength given, so none breaks");
            if (std::abs(weakest.ratio - 1.0) <= strength_tolerance) return weakest;
            const bool over = weakest.ratio > 1.0;
            Side &here = over ? above : below, &there = over ? below : above;
            if (here.force > 0.0) there.excess *= 0.5;
            here = {force_, weakest.ratio - 1.0};
            if (!(below.force > 0.0 && above.force > 0.0)) {
                force_ /= weakest.ratio;
            } else if (above.force - below.force > narrowest * above.force) {
                force_ = (below.force * above.excess - above.force * below.excess) / (above.excess - below.excess);
            } else if (over) {
                return weakest;  // the stress leaps past the strength
            } else {
                force_ = above.force;
            }
        }
        throw Error("no punch force was found at which the next bond breaks");
    }

    Weakest try_force() {
        level_ = equilibria_.trial(force_, result_);
        result_.loads = mechanics::bond_loads(result_.specimen.body.network, equilibria_.last().displacement);
        return find_weakest(result_.specimen.body.network, result_.loads, result_.broken, options_);
    }

    /// Takes the point to the curve and to the balance of energy. Up to the first break the bar is elastic: it stores the work.
    void account() {
        const Point& here = level_.point;
        max_stored_ = std::max(max_stored_, level_.energy);
        result_.failure.work += result_.breaks == 0 ? level_.energy : work_since_break();
        result_.failure.stored = level_.energy;
        result_.curve.push_back(here);
        if (here.force > result_.peak_force) {
            result_.peak_force = here.force;
            read_contacts(result_, equilibria_.tooling(), equilibria_.last());
        }
        result_.residual = std::max(result_.residual, equilibria_.last().residual);
        result_.converged = result_.converged && equilibria_.last().converged;
    }

    /// Work of the punch from the last break on, J. Where a break took away what the punch pressed on, force grows in leaps: levels
    /// in between are solved for until the curve through them is certain.
    double work_since_break() {
        double sum = 0.0;
        std::vector<Level> ahead{level_};  // the nearest last
        Level from = relaxed_;
        for (int halvings = 0; !ahead.empty();) {
            const Level& to = ahead.back();
            const WorkOfStep work = work_of_step(from, to);
            if (work.uncertainty <= work_tolerance * max_stored_ || halvings == max_halvings) {
                sum += work.value;
                from = to;
                ahead.pop_back();
            } else {
                ++halvings;
                ahead.push_back(equilibria_.trial(middle_force(from.point.force, to.point.force), result_));
            }
        }
        if (from.point.force != equilibria_.last().punch_force) try_force();
        return sum;
    }

    /// The punch stands still as a bond breaks: what is stored no more is spent.
    void relax() {
        relaxed_ = equilibria_.relaxed(result_);
        result_.converged = result_.converged && equilibria_.last().converged;
        result_.failure.dissipated += level_.energy - relaxed_.energy;
    }

    /// True while a piece that whole bonds hold together reaches from support to support.
    bool holds() const {
        const mechanics::BondedBody& body = result_.specimen.body;
        std::vector<std::array<std::int32_t, 2>> whole;
        for (std::size_t bond = 0; bond < body.network.bonds(); ++bond) {
            if (result_.broken[bond] == 0) whole.push_back(body.network.pair[bond]);
        }
        std::vector<std::int32_t> order(body.network.nodes());
        std::iota(order.begin(), order.end(), 0);
        const mechanics::Components pieces = mechanics::find_components(order, whole);
        std::vector<std::int32_t> rows;
        for (const std::int32_t node : pieces.of(pieces.largest())) rows.push_back(body.particle[static_cast<std::size_t>(node)]);
        return reaches_supports(result_.specimen, result_.fixture, rows);
    }

    void crack(std::size_t bond) {
        mechanics::BondNetwork& network = result_.specimen.body.network;
        const auto [i, j] = network.pair[bond];
        equilibria_.soften(bond, remnant, mechanics::contact_between(network, spheres_, i, j));
        physics::BondStiffness& k = network.stiffness[bond];
        k = {remnant * k.normal, remnant * k.shear, remnant * k.torsion, remnant * k.bending};
        result_.broken[bond] = static_cast<std::int32_t>(result_.breaks);
    }

    Result& result_;
    const Options& options_;
    std::vector<mechanics::ElasticSphere> spheres_;
    Equilibria equilibria_;
    double force_;
    double max_stored_ = 0.0;   // J
    double progress_ = 0.0;
    Level level_{}, relaxed_{};  // as the last bond broke; after it, under the punch that stands still
};

}  // namespace

Result bend_to_failure(State state, const Options& options, const Watch& watch) {
    Result result = prepare(std::move(state), options);
    Failure failure(result, options, watch.stop);
    while (failure.next()) watch.at(failure.progress());
    result.energy_error = failure.energy_gap();
    result.peak = std::move(failure.last());
    add_warnings(result, options);
    return result;
}

}  // namespace kiln::bending
