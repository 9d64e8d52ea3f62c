// units.h: quantities with units on the command line, such as 50nm, 1200C, 10K/min; a number without its unit is an error.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace CLI {
class App;
class Option;
}

namespace kiln::cli {

enum class Dimension {
    none,              // plain number
    length,            // m
    area,              // m2
    volume,            // m3
    time,              // s
    temperature,       // K; C is converted
    heating_rate,      // K/s
    pressure,          // Pa
    force,             // N
    velocity,          // m/s
    surface_energy,    // J/m2
    molar_energy,      // J/mol
    mass_density,      // kg/m3
    angle,             // rad
    diffusion_volume,  // m3/s, grain boundary width times diffusivity
    compliance,        // m/N
};

/// SI value of a text such as "50nm". Upper and lower case count. Throws CLI::ValidationError that says what was given and which
/// units are known.
double parse_quantity(std::string_view text, Dimension dimension);

/// The units of a dimension, for help texts: "m, mm, um, nm".
std::string known_units(Dimension dimension);

/// Adds an option that takes one quantity into target (SI). `help` ends up with units and default (shown as default_text).
CLI::Option* add_quantity(CLI::App& app, const std::string& name, double& target, Dimension dimension, const std::string& help,
                          const std::string& default_text = "");

/// The same for a comma-separated list.
CLI::Option* add_quantities(CLI::App& app, const std::string& name, std::vector<double>& target, Dimension dimension,
                            const std::string& help);

}  // namespace kiln::cli
