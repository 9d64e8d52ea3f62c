// porous_bound.h: how stiff an isotropic porous solid can be at most.
#pragma once

namespace kiln::physics {

/// Bulk and shear modulus of an isotropic solid, Pa.
struct IsotropicModuli {
    double bulk, shear;

    double young() const { return 9.0 * bulk * shear / (3.0 * bulk + shear); }
};

inline IsotropicModuli isotropic_moduli(double young_modulus, double poisson_ratio) {
    return {young_modulus / (3.0 * (1.0 - 2.0 * poisson_ratio)), young_modulus / (2.0 * (1.0 + poisson_ratio))};
}

/// Upper bounds of the moduli of an isotropic body of which the solid fills the fraction f, 0 <= f <= 1, and nothing the rest:
/// K = 4 G f K_s/(4 G + 3 K_s (1 - f)), G = f G_s (9 K_s + 8 G_s)/(9 K_s + 8 G_s + 6 (1 - f)(K_s + 2 G_s)) with the solid's own K_s
/// and G_s. Hashin & Shtrikman, J. Mech. Phys. Solids 11 (1963) 127, eqs. 4.1 to 4.4, with empty pores.
inline IsotropicModuli porous_bound(const IsotropicModuli& solid, double solid_fraction) {
    const double pores = 1.0 - solid_fraction, k = solid.bulk, g = solid.shear, stiff = 9.0 * k + 8.0 * g;
    return {4.0 * g * solid_fraction * k / (4.0 * g + 3.0 * k * pores),
            solid_fraction * g * stiff / (stiff + 6.0 * pores * (k + 2.0 * g))};
}

}  // namespace kiln::physics
