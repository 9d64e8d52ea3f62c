// options.h: what can be chosen about the bending test.
#pragma once

#include <string>

#include "mechanics/bond_network.h"
#include "mechanics/linear_solver.h"

namespace kiln::bending {

enum class Method {
    equilibria,  // static
    motion,      // dynamic
};

std::string name_of(Method method);

/// Lengths, velocities and forces that are zero stand for the default that `bend --help` states.
struct Options {
    double span = 0.0;            // m
    double punch_radius = 0.0;    // m
    double max_deflection = 0.0;  // m
    double max_force = 0.0;       // N
    int cycles = 3;
    int points = 6;  // of a branch
    double tolerance = 1e-6;
    mechanics::BondModel model;
    mechanics::LinearSolverMaker linear_solver;  // empty: the library's own
    Method method = Method::equilibria;
    double punch_velocity = 0.0;  // m/s
    double damping = 0.7;
    double friction = 0.0;
    double mass_scaling = 1.0;
    bool allow_block = false;  // bars whose span is below twice their height
    double tensile_strength = 0.0;  // Pa, of bonds; zero: they do not break so
    double shear_strength = 0.0;    // Pa
    double calibrate_to = 0.0;      // Pa, bending strength of the bar, for which the tensile strength is sought; zero: it is given
    double until = 0.1;             // of the greatest force: where a test to failure ends

    bool to_failure() const { return tensile_strength > 0.0 || shear_strength > 0.0 || calibrate_to > 0.0; }
};

}  // namespace kiln::bending
