// equilibria.h: a bar between its cylinders as equilibria under punch forces.
#pragma once

#include "mechanics/contact_problem.h"
#include "bending/result.h"
#include "core/stop.h"

namespace kiln::bending {

struct Level {
    Point point;
    double compliance;    // m/N, of the punch
    double energy, lost;  // J, stored; spent by friction since the beginning
};

/// Work of the punch from the first level to the last, J. Travel is a cubic between forces (Hermite), from its values and slopes.
double work_of_punch(std::span<const Level> levels);

struct WorkOfStep {
    double value, uncertainty;  // J
};

/// Work of the punch from one level to the next, without more between them. What two cubics leave open, travel over force and force
/// over travel, is uncertain; so is all that a force which only grows or only falls may have done, where a cubic does neither.
WorkOfStep work_of_step(const Level& from, const Level& to);

/// Equilibria of one test, its travel counted from where the punch meets the bar; their iterations, residuals and convergence go to
/// its result.
class Equilibria {
   public:
    /// stop: asked in the solves, which throw Interrupted.
    Equilibria(const Specimen& specimen, const Fixture& fixture, const Options& options, const StopRequest& stop = {});
    Equilibria(const Equilibria&) = delete;  // the contact problem refers to the solver
    Equilibria& operator=(const Equilibria&) = delete;

    /// An equilibrium on the way to one that counts: as exact as searches need, or as a first guess does.
    Level trial(double force, Result& result);
    Level guess(double force, Result& result);

    Level at(double force, Result& result);

    /// The bar with the punch held where it is in the last equilibrium, as exact as trials.
    Level relaxed(Result& result);

    /// The last equilibrium is one that the bar goes through: friction remembers it.
    void keep() { problem_.keep(); }

    /// The punch is lifted off: the bar starts anew.
    void release() { problem_.release(); }

    double friction_loss() const { return problem_.friction_loss(); }  // J, since the beginning

    mechanics::Equilibrium& last() { return last_; }

    const mechanics::Tooling& tooling() const { return tooling_; }

    /// See mechanics::ContactProblem::soften.
    void soften(std::size_t bond, double share, const mechanics::PairContact& ends) { problem_.soften(bond, share, ends); }

   private:
    double trial_tolerance() const;
    Level level_of(mechanics::Equilibrium equilibrium, Result& result);

    const mechanics::BondNetwork& network_;
    mechanics::Tooling tooling_;
    mechanics::ElasticSolver solver_;
    mechanics::ContactProblem problem_;
    Gauge gauge_;
    double tolerance_;
    mechanics::Equilibrium last_;
};

}  // namespace kiln::bending
