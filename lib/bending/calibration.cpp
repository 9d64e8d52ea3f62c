// calibration.cpp: tests to failure with bonds of other strengths, each nearer to the bar's strength that was measured.
#include "bending/calibration.h"

#include <cmath>
#include <utility>

#include "bending/failure.h"
#include "physics/bending.h"

namespace kiln::bending {

namespace {

constexpr double tolerance = 2e-3;  // of the bar's strength; each test knows it to 1e-3
constexpr double first_guess = 10.0;  // strength of bonds over that of the bar
constexpr int max_tests = 12;

double strength_of(const Result& result) {
    const Vec3& size = result.specimen.size;
    return physics::bending_strength(result.peak_force, result.fixture.span, size[1], size[2]);
}

}  // namespace

Result bend_calibrated(State state, const Options& options, const Watch& watch) {
    Options trial = options;
    trial.calibrate_to = 0.0;
    trial.tensile_strength = first_guess * options.calibrate_to;
    Result nearest;
    double least = HUGE_VAL;
    for (int test = 1; test <= max_tests; ++test) {
        Result result = bend_to_failure(state, trial, watch);
        const double off = strength_of(result) / options.calibrate_to - 1.0;
        if (std::abs(off) < least) {
            least = std::abs(off);
            nearest = std::move(result);
            nearest.calibration = {trial.tensile_strength, test};
        }
        if (least <= tolerance) return nearest;
        trial.tensile_strength /= 1.0 + off;
    }
    nearest.converged = false;
    nearest.warnings.push_back("no strength of the bonds was found with which the bar breaks at the stress of --calibrate-to: the "
                               "nearest is given");
    return nearest;
}

}  // namespace kiln::bending
