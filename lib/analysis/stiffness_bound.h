// stiffness_bound.h: whether a modulus that was found can be that of a porous body of its solid.
#pragma once

#include <optional>
#include <string>

#include "physics/porous_bound.h"

namespace kiln::analysis {

/// What to know of a Young's modulus (Pa) above what any isotropic body of that relative density can have: a sentence, else
/// nothing. Springs between pairs of particles do not know that necks share the bulk of the same particle.
std::optional<std::string> above_bound_warning(double young_modulus, const physics::IsotropicModuli& solid,
                                               double relative_density);

/// The most that it can have, Pa. A body denser than dense, by the rounding of overlaps, counts as the solid.
double young_bound(const physics::IsotropicModuli& solid, double relative_density);

}  // namespace kiln::analysis
