// static_test.h: three-point bending as a sequence of equilibria.
#pragma once

#include <functional>
#include <vector>

#include "tools/bend/fixture.h"

namespace kiln::bend {

/// One point of the curve.
struct Point {
    double deflection, punch;  // m
    double force;              // N
};

struct Result {
    Specimen specimen;
    Fixture fixture;
    std::vector<Point> curve;     // all cycles
    mechanics::Equilibrium peak;  // under the greatest force
    std::size_t contacts = 0;     // that carry force there
    std::size_t closed_gaps = 0;  // pairs without a bond that come to touch there
    int iterations = 0;           // of the linear solver, in all
    double residual = 0.0;        // greatest of all equilibria
    double energy_error = 0.0;    // work of the punch from the first point to the peak against the energy stored, relative
    bool converged = true;
};

/// Called between equilibria with the share of the work done; false stops the test.
using Watch = std::function<bool(double)>;

/// Loads and unloads the bar in equal steps of force. Throws Error where the bar cannot be tested (see place_fixture,
/// find_contacts).
Result bend_static(State state, const Options& options, const Watch& watch);

}  // namespace kiln::bend
