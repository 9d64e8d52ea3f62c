// porous_bound_test.cpp: the most that an isotropic porous body can have, and what is said of a modulus above it.
#include "physics/porous_bound.h"

#include <doctest/doctest.h>

#include <cmath>

#include "analysis/stiffness_bound.h"

using namespace kiln;

TEST_CASE("the bound of a porous body: the solid itself, nothing of nothing, and Hashin and Shtrikman's form between") {
    const physics::IsotropicModuli solid = physics::isotropic_moduli(400e9, 0.23);
    CHECK(std::abs(solid.young() / 400e9 - 1.0) < 1e-14);
    CHECK(std::abs(physics::porous_bound(solid, 1.0).young() / 400e9 - 1.0) < 1e-14);
    for (const double f : {0.3, 0.7, 0.95}) {
        const double k = solid.bulk, g = solid.shear;  // their eqs. with empty inclusions, unsimplified
        const physics::IsotropicModuli bound = physics::porous_bound(solid, f);
        CHECK(std::abs(bound.bulk / (k + (1.0 - f) / (-1.0 / k + 3.0 * f / (3.0 * k + 4.0 * g))) - 1.0) < 1e-12);
        CHECK(std::abs(bound.shear / (g + (1.0 - f) / (-1.0 / g + 6.0 * f * (k + 2.0 * g) / (5.0 * g * (3.0 * k + 4.0 * g)))) -
                       1.0) < 1e-12);
        CHECK(bound.young() < f * 400e9);
    }
    // With nu = 0.2 both moduli fall by the same factor f/(2 - f).
    const physics::IsotropicModuli fifth = physics::isotropic_moduli(100e9, 0.2);
    CHECK(std::abs(physics::porous_bound(fifth, 0.8).young() / (100e9 * 0.8 / 1.2) - 1.0) < 1e-12);
}

TEST_CASE("a modulus above the bound is said, with both and the density; one at it or below is not") {
    const physics::IsotropicModuli solid = physics::isotropic_moduli(100e9, 0.2);
    const double bound = 100e9 * 0.8 / 1.2;
    CHECK_FALSE(analysis::above_bound_warning(bound, solid, 0.8));
    const auto sentence = analysis::above_bound_warning(70e9, solid, 0.8);
    REQUIRE(sentence);
    CHECK(sentence->find("E of 70 GPa is above 66.67 GPa") == 0);
    CHECK(analysis::above_bound_warning(101e9, solid, 1.02));  // denser than dense by rounding of overlaps: the solid's own
}
