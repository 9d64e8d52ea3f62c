// stiffness_bound.cpp: the sentence on moduli above the bound.
#include "analysis/stiffness_bound.h"

#include <algorithm>
#include <cstdio>

namespace kiln::analysis {

namespace {

constexpr double rounding = 1e-6;  // of linear solves

}  // namespace

double young_bound(const physics::IsotropicModuli& solid, double relative_density) {
    return physics::porous_bound(solid, std::clamp(relative_density, 0.0, 1.0)).young();
}

std::optional<std::string> above_bound_warning(double young_modulus, const physics::IsotropicModuli& solid,
                                               double relative_density) {
    const double bound = young_bound(solid, relative_density);
    if (!(young_modulus > bound * (1.0 + rounding))) return std::nullopt;
    char words[400];
    std::snprintf(
        words, sizeof words,
        "E of %.4g GPa is above %.4g GPa, the most that an isotropic body of this solid has at a relative density of %.3g "
        "(Hashin & Shtrikman 1963): bonds between pairs of particles are too stiff there; analyze elastic --model voxel "
        "takes the body as it is",
        young_modulus / 1e9, bound / 1e9, relative_density);
    return words;
}

}  // namespace kiln::analysis
