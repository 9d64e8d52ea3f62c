// contact_friction.cpp: equilibria with friction: limits that follow the normal forces, and the path from load to load.
#include <cmath>
#include <sstream>

#include "mechanics/contact_problem.h"

namespace kiln::mechanics {

namespace {

constexpr int most_passes = 200;
constexpr double limit_tolerance = 1e-9;  // change of a friction limit over the punch force

}  // namespace

/// Minima for limits of friction that are taken anew from each; false if they go on changing.
bool ContactProblem::settle(const Drive& drive) {
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
    for (int pass = 0; pass < most_passes; ++pass) {
        const double change = grips_.follow(overlaps());
        if (pass > 0 && change <= limit_tolerance * drive.force) return true;
        minimise(drive);
    }
    return false;
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
