// result.h: what a bending test found, whatever its method.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mechanics/explicit_motion.h"
#include "bending/fixture.h"

namespace kiln::bending {

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

/// Of a test to failure in which the punch stands still whenever a bond breaks, J.
struct FailureEnergy {
    double work = 0.0;        // of the punch
    double stored = 0.0;      // at the end
    double dissipated = 0.0;  // by breaks: what was stored before each of them less what was after it
};

/// The strength of bonds that was found for a strength of the bar.
struct Calibration {
    double tensile_strength = 0.0;  // Pa
    int tests = 0;                  // to failure, that it took
};

struct Result {
    Specimen specimen;
    Fixture fixture;
    std::vector<Point> curve;                // all cycles
    mechanics::Equilibrium peak;             // under the greatest force; of a test to failure, at its end
    std::vector<mechanics::BondLoad> loads;  // of the bonds there
    double peak_force = 0.0;                 // N
    double held_span = 0.0;                  // m, between the supports' resultants under the greatest force
    bool on_both_supports = true;            // there
    double thrust = 0.0;                     // N, there, see thrust() of fixture.h
    std::size_t contacts = 0;                // that carry force there
    std::size_t closed_gaps = 0;             // pairs without a bond that come to touch there
    int iterations = 0;                      // of the linear solver, in all
    double residual = 0.0;                   // greatest of all equilibria
    double friction_loss = 0.0;              // J, in the whole test
    double energy_error = 0.0;               // greatest gap between work of the punch and all energy, over that stored at the peak
    bool converged = true;
    double tilt = 0.0;                 // rad, most that the bar turned as a whole under load, after it was seated
    std::vector<std::string> warnings;  // sentences: why the test may not say what it seems to say
    DynamicRun dynamic;                // of the dynamic method
    std::size_t breaks = 0;            // of bonds, in a test to failure
    std::vector<std::int32_t> broken;  // for each bond its place in the order of breaks, from 1; 0 for a whole one
    FailureEnergy failure;
    std::optional<Calibration> calibration;
};

/// The bar cut, its cylinders placed, the bar at rest between them, and the point of the curve without load. Throws Error where the
/// bar cannot be tested (see cut_specimen, place_fixture, seat_bar).
Result prepare(State state, const Options& options);

/// Mean rotation of the nodes about x and y, rad.
double mean_turn(const mechanics::BondNetwork& network, const linalg::Vector& displacement);

/// Adds the warnings that a finished test calls for.
void add_warnings(Result& result, const Options& options);

/// Takes what the contacts carry in an equilibrium as that of the greatest force.
void read_contacts(Result& result, const mechanics::Tooling& tooling, const mechanics::Equilibrium& equilibrium);

}  // namespace kiln::bending
