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
constexpr int most_trials = 20;
constexpr std::size_t most_breaks = 100000;

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

/// A bar that loses its bonds one after the other.
class Failure {
   public:
    Failure(Result& result, const Options& options)
        : result_(result),
          options_(options),
          spheres_(mechanics::elastic_spheres(result.specimen.state, result.specimen.body)),
          equilibria_(result.specimen, result.fixture, options),
          force_(estimated_stiffness(result.specimen, result.fixture) * greatest_deflection(result.specimen, options)) {
        result_.broken.assign(result.specimen.body.network.bonds(), 0);
        equilibria_.seat(force_);
    }

    /// False once the force has fallen far enough.
    bool next() {
        const Weakest weakest = load();
        account();
        if (level_.point.force <= options_.until * result_.peak_force) return false;
        if (++result_.breaks == most_breaks)
            throw Error("the bar did not fail although " + std::to_string(most_breaks) + " bonds broke");
        crack(weakest.bond);
        if (holds()) {
            relax();
            return true;
        }
        result_.curve.push_back({level_.point.deflection, level_.point.punch, 0.0});
        result_.failure.dissipated += std::exchange(result_.failure.stored, 0.0);
        return false;
    }

    mechanics::Equilibrium& last() { return equilibria_.last(); }

    /// Gap between the work of the punch and all energy, over the most that was stored.
    double energy_gap() const {
        const FailureEnergy& energy = result_.failure;
        return std::abs(energy.work - energy.stored - energy.dissipated) / most_stored_;
    }

   private:
    /// The equilibrium in which the weakest bond has just reached its strength: stresses grow nearly as the force.
    Weakest load() {
        for (int trial = 0; trial < most_trials; ++trial) {
            level_ = equilibria_.trial(force_, result_);
            result_.loads = mechanics::bond_loads(result_.specimen.body.network, equilibria_.last().displacement);
            const Weakest weakest = find_weakest(result_.specimen.body.network, result_.loads, result_.broken, options_);
            if (!(weakest.ratio > 0.0)) throw Error("no bond of the bar is stressed towards the strength given, so none breaks");
            if (std::abs(weakest.ratio - 1.0) <= strength_tolerance) return weakest;
            force_ /= weakest.ratio;
        }
        throw Error("no punch force was found at which the next bond breaks");
    }

    /// Takes the point to the curve and to the balance of energy. Up to the first break the bar is elastic: it stores the work.
    void account() {
        const Point& here = level_.point;
        result_.failure.work += result_.breaks == 0 ? level_.energy : work_of_punch(std::array{relaxed_, level_});
        result_.failure.stored = level_.energy;
        most_stored_ = std::max(most_stored_, level_.energy);
        result_.curve.push_back(here);
        if (here.force > result_.peak_force) {
            result_.peak_force = here.force;
            read_contacts(result_, equilibria_.tooling(), equilibria_.last());
        }
        result_.residual = std::max(result_.residual, equilibria_.last().residual);
        result_.converged = result_.converged && equilibria_.last().converged;
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
        const mechanics::Pieces pieces = mechanics::find_pieces(order, whole);
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
    double most_stored_ = 0.0;   // J
    Level level_{}, relaxed_{};  // as the last bond broke; after it, under the punch that stands still
};

}  // namespace

Result bend_to_failure(State state, const Options& options, const Watch& watch) {
    Result result = prepare(std::move(state), options);
    Failure failure(result, options);
    while (failure.next()) {
        if (!watch(0.0)) return result;
    }
    result.energy_error = failure.energy_gap();
    result.peak = std::move(failure.last());
    return result;
}

}  // namespace kiln::bending
