// relaxation_test.cpp: spheres that push each other apart, against closed forms.
#include "packing/relaxation.h"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "tests/physics/relative.h"

using namespace kiln;
using namespace kiln::packing;
using kiln::test::relative;

namespace {

Box box_of(const Vec3& lengths) {
    Box box;
    box.lengths = lengths;
    return box;
}

}  // namespace

TEST_CASE("relaxation: every pair parts in the same steps, whatever its sizes, about its centre of mass") {
    int steps = 0;
    for (const double ratio : {1.0, 0.3, 0.05}) {
        CAPTURE(ratio);
        const std::vector<double> radius{1e-7, ratio * 1e-7};
        const double reach = radius[0] + radius[1];
        std::vector<Vec3> position{{5e-7, 5e-7, 5e-7}, {5e-7 + 0.9 * reach, 5e-7, 5e-7}};
        const auto centre = [&] { return (position[0] + std::pow(ratio, 3) * position[1]) / (1.0 + std::pow(ratio, 3)); };
        const Vec3 before = centre();
        const Relaxation end = relax(box_of(Vec3::Constant(1e-6)), radius, position, {});
        CHECK(end.finished);
        CHECK(end.max_overlap <= 1e-5);
        CHECK((position[1] - position[0]).norm() >= (1.0 - 1e-5) * reach);
        CHECK((centre() - before).norm() < 1e-14 * reach * end.steps);
        CHECK((position[1] - position[0]).tail<2>().norm() == 0.0);
        if (steps == 0) steps = end.steps;
        CHECK(end.steps == steps);
    }
}

TEST_CASE("relaxation: steps of a pair follow the damped oscillator h'' = -2 h - 2 sqrt 2 D h'") {
    // From rest, h = exp(-a t) (cos w t + a/w sin w t) with a = sqrt 2 D and w = sqrt(2 - a a); steps are 0.2 long, first order.
    const double damping = 0.3, a = std::sqrt(2.0) * damping, w = std::sqrt(2.0 - a * a);
    const std::vector<double> radius{1.0, 1.0};
    std::vector<Vec3> position{{4.0, 5.0, 5.0}, {5.8, 5.0, 5.0}};
    std::vector<double> overlap;
    relax(box_of(Vec3::Constant(10.0)), radius, position, {.damping = damping}, {},
          [&](const Relaxation& now) { overlap.push_back(now.max_overlap / 0.1); });
    for (std::size_t step = 0; step + 1 < overlap.size(); ++step) {
        const double t = 0.2 * static_cast<double>(step);
        CAPTURE(step);
        CHECK(std::abs(overlap[step] - std::exp(-a * t) * (std::cos(w * t) + a / w * std::sin(w * t))) < 0.1);
    }
    // The oscillator parts at t = (pi - atan(w/a))/w = 1.41: within a step of 7.
    const double parts = (std::numbers::pi - std::atan(w / a)) / w / 0.2;
    CHECK(std::abs(static_cast<double>(overlap.size() - 1) - parts) < 1.5);
}

TEST_CASE("relaxation: a row too long for its box jams with the overlap shared equally") {
    // Four spheres of diameter 2 in a box of 7: each of the four contacts keeps (8 - 7)/4 of 2.
    const std::vector<double> radius(4, 1.0);
    std::vector<Vec3> position;
    for (const double x : {0.1, 1.9, 3.4, 5.3}) position.push_back({x, 5.0, 5.0});
    const Relaxation end = relax(box_of({7.0, 10.0, 10.0}), radius, position, {});
    CHECK(end.jammed);
    CHECK_FALSE(end.finished);
    CHECK(end.contacts == 4);
    CHECK(end.max_overlap == relative(0.125, 1e-3));
    CHECK(end.mean_overlap == relative(0.125, 1e-9));
}

TEST_CASE("relaxation: pushing keeps the total momentum at nothing") {
    std::mt19937_64 bits(2);
    const auto uniform = [&] { return static_cast<double>(bits() >> 11) * 0x1p-53; };
    Box box = box_of(Vec3::Constant(10.0));
    box.periodic = {false, false, false};
    std::vector<double> radius;
    std::vector<Vec3> position;
    double mass = 0.0;
    for (int row = 0; row < 60; ++row) {
        radius.push_back(0.5 + uniform());
        position.push_back({3.0 + 4.0 * uniform(), 3.0 + 4.0 * uniform(), 3.0 + 4.0 * uniform()});
        mass += std::pow(radius.back(), 3);
    }
    const auto centre = [&] {
        Vec3 sum = Vec3::Zero();
        for (std::size_t row = 0; row < radius.size(); ++row) sum += std::pow(radius[row], 3) / mass * position[row];
        return sum;
    };
    const Vec3 before = centre();
    const Relaxation end = relax(box, radius, position, {});
    CHECK(end.finished);
    CHECK(end.steps > 10);
    CHECK((centre() - before).norm() < 1e-12);
}

TEST_CASE("relaxation: a stop request ends it, and the most steps do") {
    const std::vector<double> radius{1.0, 1.0};
    std::vector<Vec3> position{{4.0, 5.0, 5.0}, {4.5, 5.0, 5.0}};
    const Box box = box_of(Vec3::Constant(10.0));
    int asked = 0;
    CHECK_THROWS_AS(relax(box, radius, position, {}, [&] { return ++asked == 3; }), Interrupted);
    CHECK(asked == 3);
    const Relaxation end = relax(box, radius, position, {.max_steps = 1});
    CHECK(end.steps == 1);
    CHECK_FALSE(end.finished);
    CHECK_FALSE(end.jammed);
}
