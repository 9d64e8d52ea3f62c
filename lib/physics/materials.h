// materials.h: built-in materials with their sources, and what a calculation asks of a material.
#pragma once

#include <string>
#include <vector>

#include "core/state.h"

namespace kiln::physics {

/// A built-in material by name. Throws Error that lists the known names.
Material builtin_material(const std::string& name);

/// Names of the built-in materials.
std::vector<std::string> builtin_names();

/// What required() throws.
struct MissingConstant : Error {
    using Error::Error;
};

/// A material's value, or MissingConstant "material 'X' has no KEY".
double required(const std::optional<double>& value, const Material& material, const std::string& key);

/// Delta of a material at a temperature (K), m5/(N s): its constant diffusion_parameter, or by grain boundary diffusion.
/// Throws Error that names the missing key.
double diffusion_parameter_of(const Material& material, double temperature);

/// D_s' = Omega delta_s D_s/(k_B T) of surface diffusion at a temperature (K), m6/(J s). Throws Error that names the missing key.
double surface_diffusion_of(const Material& material, double temperature);

/// Mobility of grain boundaries at a temperature (K), m4/(J s). Throws Error that names the missing key.
double boundary_mobility_of(const Material& material, double temperature);

}  // namespace kiln::physics
