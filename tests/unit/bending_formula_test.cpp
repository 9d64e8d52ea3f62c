// bending_formula_test.cpp: the bending modulus against the Timoshenko beam it comes from.
#include <doctest/doctest.h>

#include <cmath>

#include "analysis/slenderness.h"
#include "core/types.h"
#include "physics/bending.h"
#include "tests/physics/relative.h"

using namespace kiln::physics;
using kiln::test::relative;

TEST_CASE("bending modulus inverts the deflection of a Timoshenko beam") {
    const double modulus = 400e9, poisson_ratio = 0.23, span = 30e-3, width = 4e-3, height = 3e-3, force = 60.0;
    const double shear_modulus = modulus / (2.0 * (1.0 + poisson_ratio));
    const double moment_of_area = width * height * height * height / 12.0;
    const double bending = force * span * span * span / (48.0 * modulus * moment_of_area);
    const double shear = force * span / (4.0 * (5.0 / 6.0) * shear_modulus * width * height);
    CHECK(bending_modulus(force / (bending + shear), span, width, height, poisson_ratio) == relative(modulus, 1e-13));
    CHECK(shear_correction(height, span, poisson_ratio) == relative((bending + shear) / bending, 1e-13));
}

TEST_CASE("equivalent span: none to make up for where forces act at its ends, else the bar's deflection between straight ends") {
    CHECK(equivalent_span(3.0, 3.0) == relative(3.0, 1e-14));
    // Held 2 apart, read 3 apart: 2^3 of the beam between its supports and 3/2 2^2 of the slope at them over half the difference.
    CHECK(equivalent_span(2.0, 3.0) == relative(std::cbrt(8.0 + 6.0), 1e-14));
}

TEST_CASE("shear counts for 2.4 (1 + nu) (h/L)2, next to nothing in a slender bar") {
    CHECK(shear_correction(1.0, 1e6, 0.5) - 1.0 == relative(3.6e-12, 1e-3));
}

TEST_CASE("bending modulus of geometrically similar bars: slopes grow with length") {
    CHECK(bending_modulus(2.0, 8.0, 2.0, 1.0, 0.2) == relative(bending_modulus(2e-6, 8e-6, 2e-6, 1e-6, 0.2), 1e-13));
}

TEST_CASE("short bars: a sentence below L/h = 4 with what shear does to E, and a refusal below 2") {
    using namespace kiln::analysis;
    CHECK_FALSE(short_bar_warning(4.0, 1.0, shear_correction(1.0, 4.0, 0.23)));
    const auto sentence = short_bar_warning(3.2, 1.0, shear_correction(1.0, 3.2, 0.23));
    REQUIRE(sentence);
    CHECK(is_short_bar_warning(*sentence));
    CHECK(sentence->starts_with("L/h (span over height) is 3.2, below 4: shear is 22 % of a beam's deflection"));  // 1 - 1/1.288
    CHECK(sentence->find("factor 1.29") != std::string::npos);
    CHECK(short_bar_warning(3.2, 1.0, 1.0)->find("no factor") != std::string::npos);
    CHECK(short_bar_warning(3.2, 1.0, std::nullopt)->find("strength lies above") != std::string::npos);
    CHECK_NOTHROW(refuse_block(2.0, 1.0, "--allow-block"));
    CHECK_THROWS_WITH_AS(refuse_block(0.8e-6, 1e-6, "--allow-block"),
                         "L/h (span over height) is 0.8: below 2 it is a block, of which the formulas of beams give up to several "
                         "times the modulus; bend a bar (sinter green --aspect 6:1:1), or give --allow-block",
                         kiln::Error);
}
