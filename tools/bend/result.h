// result.h: what a bending test found, whatever its method.
#pragma once

#include <functional>
#include <vector>

#include "mechanics/explicit_motion.h"
#include "tools/bend/fixture.h"

namespace kiln::bend {

/// One point of the curve.
struct Point {
    double deflection, punch;  // m
    double force;              // N
};

/// How a dynamic test was run.
struct DynamicRun {
    double time_step = 0.0;  // s
    double velocity = 0.0;   // m/s, of the punch
    std::size_t steps = 0;
    mechanics::MotionEnergy energy;  // J, at the end
};

struct Result {
    Specimen specimen;
    Fixture fixture;
    std::vector<Point> curve;                // all cycles
    mechanics::Equilibrium peak;             // under the greatest force
    std::vector<mechanics::BondLoad> loads;  // of the bonds there
    double peak_force = 0.0;                 // N
    std::size_t contacts = 0;                // that carry force there
    std::size_t closed_gaps = 0;             // pairs without a bond that come to touch there
    int iterations = 0;                      // of the linear solver, in all
    double residual = 0.0;                   // greatest of all equilibria
    double energy_error =
        0.0;  // relative: work of the punch to the peak against the energy stored; at all points against all energy (dynamic)
    bool converged = true;
    DynamicRun dynamic;  // of the dynamic method
};

/// Called between equilibria with the share of the work done; false stops the test.
using Watch = std::function<bool(double)>;

}  // namespace kiln::bend
