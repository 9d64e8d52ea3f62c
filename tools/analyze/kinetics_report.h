// kinetics_report.h: the fits of `analyze kinetics` and their JSON.
#pragma once

#include <string>
#include <vector>

#include "io/json.h"
#include "tools/analyze/kinetics_input.h"

namespace kiln::analyze {

/// What was measured, and what of it is fitted.
struct Measured {
    std::vector<analysis::DensityCurve> fitted;
    std::vector<analysis::DensityCurve> held_out;
    std::vector<analysis::DensityCurve> firings;    // one density each, fitted
    std::vector<analysis::DensityCurve> predicted;  // one density each, not fitted; NaN where none was measured
    std::vector<analysis::GrainSize> grains;
};

/// Activation energies of the fitted curves without a model; null for curves of which no two pass one density.
Json model_free_json(const std::vector<analysis::DensityCurve>& curves, const std::vector<double>& densities);

/// The fit of every body, what it says of all curves, and the band between the bodies.
Json bodies_json(const Measured& measured, const std::vector<Body>& bodies);

/// The curves as they were read.
Json curves_json(const Measured& measured);

}  // namespace kiln::analyze
