// envelope_test.cpp: volumes that a rolling ball feels, against closed forms. The grid has 12 points on a diameter.
#include "analysis/envelope.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "tests/physics/relative.h"

using namespace kiln;
using kiln::analysis::envelope_volume;
using kiln::test::relative;
using std::numbers::pi;

namespace {

// Where the ball lies in a groove its centre is at a crease, which the grid meets to a part of its step: 1.5 % of these volumes.
constexpr double in_grooves = 0.02;

/// Spheres of one radius in a box without periodic faces.
State spheres(const std::vector<Vec3>& position, double radius) {
    State state;
    state.box.lengths = Vec3::Constant(1e-5);
    state.box.periodic = {false, false, false};
    state.particles.position = position;
    state.particles.radius.assign(position.size(), radius);
    return state;
}

/// Volume of two spheres of radius r with centres 2 a apart and of the fillet that a ball of radius p leaves between them. Across
/// the neck the profile is w - sqrt(p2 - x2), w being the distance of the ball's centre from the axis, up to x = a p/(r + p), where
/// it goes over into that of the spheres.
double two_spheres(double r, double a, double p) {
    const double w = std::sqrt((r + p) * (r + p) - a * a), x = a * p / (r + p);
    const double neck = (w * w + p * p) * x - x * x * x / 3.0 - w * (x * std::sqrt(p * p - x * x) + p * p * std::asin(x / p));
    const double rest = r * r * (a + r - x) - (r * r * r - std::pow(x - a, 3)) / 3.0;
    return 2.0 * pi * (neck + rest);
}

}  // namespace

TEST_CASE("envelope: of one sphere its volume, wherever it lies on the grid") {
    for (const double shift : {0.0, 0.013e-7, 0.31e-7})
        for (const double probe : {0.5e-7, 2e-7})
            CHECK(envelope_volume(spheres({Vec3(1e-7 + shift, 2e-7, 3e-7 - shift)}, 1e-7), probe) ==
                  relative(4.0 / 3.0 * pi * 1e-21, 0.01));
}

TEST_CASE("envelope: of two spheres with the fillet that the ball leaves between them") {
    // Touching, overlapping, and apart by half a radius: the ball does not go through in any.
    for (const double a : {0.8e-7, 1e-7, 1.25e-7}) {
        CAPTURE(a);
        const State pair = spheres({Vec3(0.0, 0.0, 0.0), Vec3(2.0 * a, 0.0, 0.0)}, 1e-7);
        CHECK(envelope_volume(pair, 1e-7) == relative(two_spheres(1e-7, a, 1e-7), in_grooves));
    }
    // A small ball that passes between spheres apart leaves just the spheres.
    const State apart = spheres({Vec3(0.0, 0.0, 0.0), Vec3(3e-7, 0.0, 0.0)}, 1e-7);
    CHECK(envelope_volume(apart, 0.3e-7) == relative(8.0 / 3.0 * pi * 1e-21, 0.01));
}

TEST_CASE("envelope: a hollow that the ball does not reach belongs to the body") {
    std::vector<Vec3> full, hollow;
    for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
            for (int z = -1; z <= 1; ++z) {
                full.push_back(2e-7 * Vec3(x, y, z));
                if (x != 0 || y != 0 || z != 0) hollow.push_back(full.back());
            }
    const double volume = envelope_volume(spheres(full, 1e-7), 1e-7);
    CHECK(envelope_volume(spheres(hollow, 1e-7), 1e-7) == relative(volume, 1e-12));
    CHECK(volume > 27.0 * 4.0 / 3.0 * pi * 1e-21);
    CHECK(volume < 6e-7 * 6e-7 * 6e-7);
}

TEST_CASE("envelope: a row of spheres through periodic faces is a rod with the fillets between them") {
    State row = spheres({Vec3(0.0, 0.0, 0.0), Vec3(0.0, 0.0, 2e-7), Vec3(0.0, 0.0, 4e-7)}, 1e-7);
    row.box.lengths[2] = 6e-7;
    row.box.periodic[2] = true;
    // Each sphere with half a fillet at either side: two spheres that touch, less the two outer halves.
    CHECK(envelope_volume(row, 1e-7) == relative(3.0 * (two_spheres(1e-7, 1e-7, 1e-7) - 4.0 / 3.0 * pi * 1e-21), in_grooves));
}

TEST_CASE("envelope: particles too far apart for a grid are an error") {
    const State pair = spheres({Vec3::Zero(), Vec3::Constant(1.0)}, 1e-7);
    CHECK_THROWS_WITH_AS(envelope_volume(pair, 1e-7), doctest::Contains("too far apart"), Error);
}
