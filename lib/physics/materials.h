// materials.h: built-in materials with their sources, and what a calculation asks of a material.
#pragma once

#include <string>
#include <vector>

#include "core/state.h"

namespace kiln::physics {

/// A constant of a built-in material: its key in the format, what it is of, and where it stands.
struct ConstantSource {
    std::string key, meaning, source;
};

struct BuiltinMaterial {
    Material material;
    std::string about;                    // what it is, and what is missing and why
    std::vector<ConstantSource> sources;  // one for each key that it has
};

const std::vector<BuiltinMaterial>& builtin_materials();

/// A built-in material by name. Throws Error that lists the known names.
Material builtin_material(const std::string& name);

/// Names of the built-in materials.
std::vector<std::string> builtin_names();

/// What is done with a material; each needs constants of its own.
enum class Use { sintering, surface_coarsening, boundary_coarsening, elasticity, inertia };

/// "sintering", "coarsening by surface diffusion", "coarsening by boundaries", "elasticity", "inertia".
std::string name_of(Use use);

/// The keys of the format that a material would have to have for a use and has not.
std::vector<std::string> missing_constants(const Material& material, Use use);

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
