// bending_formula_test.cpp: the bending modulus against the Timoshenko beam it comes from.
#include <doctest/doctest.h>

#include <cmath>

#include "physics/bending.h"

using namespace kiln::physics;
using doctest::Approx;

TEST_CASE("bending modulus inverts the deflection of a Timoshenko beam") {
    const double modulus = 400e9, poisson_ratio = 0.23, span = 30e-3, width = 4e-3, height = 3e-3, force = 60.0;
    const double shear_modulus = modulus / (2.0 * (1.0 + poisson_ratio));
    const double moment_of_area = width * height * height * height / 12.0;
    const double bending = force * span * span * span / (48.0 * modulus * moment_of_area);
    const double shear = force * span / (4.0 * (5.0 / 6.0) * shear_modulus * width * height);
    CHECK(bending_modulus(force / (bending + shear), span, width, height, poisson_ratio) == Approx(modulus).epsilon(1e-13));
    CHECK(shear_correction(height, span, poisson_ratio) == Approx((bending + shear) / bending).epsilon(1e-13));
}

TEST_CASE("equivalent span: none to make up for where forces act at its ends, else the bar's deflection between straight ends") {
    CHECK(equivalent_span(3.0, 3.0) == Approx(3.0).epsilon(1e-14));
    // Held 2 apart, read 3 apart: 2^3 of the beam between its supports and 3/2 2^2 of the slope at them over half the difference.
    CHECK(equivalent_span(2.0, 3.0) == Approx(std::cbrt(8.0 + 6.0)).epsilon(1e-14));
}

TEST_CASE("bending modulus of a slender bar does not depend on its Poisson ratio") {
    CHECK(shear_correction(1.0, 1e6, 0.5) == Approx(1.0).epsilon(1e-11));
}

TEST_CASE("bending modulus of geometrically similar bars: slopes grow with length") {
    CHECK(bending_modulus(2.0, 8.0, 2.0, 1.0, 0.2) == Approx(bending_modulus(2e-6, 8e-6, 2e-6, 1e-6, 0.2)).epsilon(1e-13));
}
