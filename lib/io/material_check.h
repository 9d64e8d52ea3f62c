// material_check.h: what a material that was read without an error may have wrong: keys that nobody reads, values far from any
// solid's, constants that are not there.
#pragma once

#include <string>
#include <vector>

#include "core/state.h"
#include "physics/materials.h"

namespace kiln::io {

/// One sentence on each key of a material that no program reads, with the key that it may have been meant for. Keys for remarks,
/// such as source and comment, are not among them.
std::vector<std::string> unknown_keys(const Material& material);

/// One sentence on each constant of these uses that no solid has, such as a Young's modulus of 210 Pa.
std::vector<std::string> implausible_constants(const Material& material, const std::vector<physics::Use>& uses);

/// "material 'X' has no surface_energy, which sintering needs, and no young_modulus, poisson_ratio, which elasticity needs"; empty
/// if nothing is missing. A key that no program reads and that may have been meant for one of them is named.
std::string missing_sentence(const Material& material, const std::vector<physics::Use>& uses);

}  // namespace kiln::io
