// options.h: the options of `sinter`, with their defaults, units and checks.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "numerics/sintering.h"

namespace kiln::sinter {

struct Options {
    std::vector<double> densities;  // relative, wanted states
    std::vector<double> times;      // s, wanted states
    double every = 0.0;             // s, between states; 0: none
    double temperature = 0.0;       // K
    std::string history;            // file of one JSON line a step
    double tolerance = 1e-3;
    physics::ContactConstants constants;

    void add_to(CLI::App& app);

    /// Checks options against each other; throws CLI::ValidationError.
    void check() const;

    numerics::SinteringSettings settings() const;
};

}  // namespace kiln::sinter
