// contact_friction.cpp: equilibria with friction: limits that follow the normal forces, and the path from load to load.
#include <algorithm>
#include <cmath>

#include "mechanics/contact_problem.h"

namespace kiln::mechanics {

namespace {

constexpr int most_passes = 200;
constexpr int idle_passes = 10;           // in a row that bring the limits no closer: rounding has the last word
constexpr double limit_tolerance = 1e-9;  // change of a friction limit over the punch force
constexpr double limit_share = 0.1;       // the same, of the tolerance for unbalanced forces where that is finer

}  // namespace

/// Minima for limits of friction that are taken anew from each; false if they go on changing. The limits are forces that the
/// minimum takes as given, so they have to be known better than the forces are to be balanced.
bool ContactProblem::settle(const Drive& drive, double tolerance) {
    if (!grips_.active()) {
        minimise(drive);
        return true;
    }
    if (rigid_motions_ == 3) {
        add_rigid_motion(Vec3::UnitX(), Vec3::Zero());
        add_rigid_motion(Vec3::UnitY(), Vec3::Zero());
        add_rigid_motion(Vec3::Zero(), Vec3::UnitZ());
    }
    if (!gripped_) {
        grips_.stick(drive.force);
        minimise(drive);
        gripped_ = true;
    }
    const double wanted = std::min(limit_tolerance, limit_share * tolerance) * drive.force;
    double least = HUGE_VAL;
    for (int pass = 0, idle = 0; pass < most_passes && idle < idle_passes; ++pass) {
        const double change = grips_.follow(overlaps());
        if (pass > 0) {  // the first change is that of the load
            if (change <= wanted) return true;
            idle = change < least ? 0 : idle + 1;
            least = std::min(least, change);
        }
        minimise(drive);
    }
    return least <= tolerance * drive.force;
}

void ContactProblem::keep() {
    if (!grips_.active()) return;
    grips_.keep(overlaps(), slides());
    kept_ = amplitude_;
}

void ContactProblem::release() {
    amplitude_.setZero();
    amplitude_.head(seated_.size()) = seated_;
    kept_ = amplitude_;
    gripped_ = false;
    grips_.release(overlaps(), slides());
}

}  // namespace kiln::mechanics
