// quantity_options.h: options that take quantities with units, such as 50nm, 1200C, 10K/min; a number without its unit is an error.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "core/types.h"
#include "io/quantity.h"

namespace kiln::cli {

/// What parse() gives; what it says of a text becomes a usage error that names the option.
template <typename Parse>
auto parsed(const std::string& option, const Parse& parse) {
    try {
        return parse();
    } catch (const TextError& error) {
        throw CLI::ValidationError(option + ": " + error.what());
    }
}

/// Adds an option that takes one quantity into target (SI). `help` ends up with units and default (shown as default_text).
CLI::Option* add_quantity(CLI::App& app, const std::string& name, double& target, io::Dimension dimension, const std::string& help,
                          const std::string& default_text = "");

/// The same for a comma-separated list.
CLI::Option* add_quantities(CLI::App& app, const std::string& name, std::vector<double>& target, io::Dimension dimension,
                            const std::string& help);

}  // namespace kiln::cli
