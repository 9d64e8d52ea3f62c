// interpolate_test.cpp: states between two states.
#include "analysis/interpolate.h"

#include <doctest/doctest.h>

#include "tests/physics/relative.h"

using namespace kiln;
using kiln::analysis::interpolated;
using kiln::test::relative;

namespace {

/// Two particles and their bond.
State early() {
    State state;
    state.time = 10.0;
    state.temperature = 1000.0;
    state.box.origin = {1.0, 0.0, 0.0};
    state.box.lengths = {2.0, 4.0, 4.0};
    state.particles.id = {7, 3};
    state.particles.position = {{1.1, 1.0, 2.0}, {2.5, 1.0, 2.0}};
    state.particles.radius = {0.5, 0.25};
    state.particles.material = {0, 0};
    state.bonds = Bonds{{{0, 1}}, {{0, 0, 0}}, {0.1}, {0.4}, {0.02}, {}};
    return state;
}

State late() {
    State state = early();
    state.time = 30.0;
    state.temperature = 1400.0;
    state.box.origin = {1.2, 0.0, 0.0};
    state.box.lengths = {1.6, 4.0, 4.0};
    state.particles.radius = {0.6, 0.35};
    state.bonds = Bonds{{{0, 1}}, {{0, 0, 0}}, {0.3}, {0.2}, {0.06}, {}};
    return state;
}

}  // namespace

TEST_CASE("interpolation: time, temperature, box, radii and bonds are linear in the share") {
    const State state = interpolated(early(), late(), 0.25);
    CHECK(state.time == 15.0);
    CHECK(*state.temperature == 1100.0);
    CHECK(state.box.origin[0] == relative(1.05, 1e-15));
    CHECK(state.box.lengths[0] == relative(1.9, 1e-15));
    CHECK(state.particles.radius[0] == relative(0.525, 1e-15));
    CHECK(state.bonds->radius[0] == relative(0.15, 1e-15));
    CHECK(state.bonds->length[0] == relative(0.35, 1e-15));
    CHECK(state.bonds->volume[0] == relative(0.03, 1e-15));
}

TEST_CASE("interpolation: at either end it is that state, whatever the order of its rows") {
    State last = late();
    std::swap(last.particles.id[0], last.particles.id[1]);
    std::swap(last.particles.radius[0], last.particles.radius[1]);
    std::swap(last.particles.position[0], last.particles.position[1]);
    last.bonds->pair[0] = {1, 0};
    const State first = early(), there = interpolated(first, last, 1.0), here = interpolated(first, last, 0.0);
    CHECK(there.particles.id == first.particles.id);
    for (std::size_t row = 0; row < 2; ++row) {
        CHECK(here.particles.radius[row] == first.particles.radius[row]);
        CHECK((here.particles.position[row] - first.particles.position[row]).norm() < 1e-15);
        CHECK(there.particles.radius[row] == relative(late().particles.radius[row], 1e-15));
        CHECK((there.particles.position[row] - late().particles.position[row]).norm() < 1e-15);
    }
}

TEST_CASE("interpolation: a particle goes the nearer way around through periodic faces, and straight where they are free") {
    State first = early(), last = early();
    first.particles.position[0] = {1.1, 1.0, 2.0};
    last.particles.position[0] = {2.9, 1.0, 2.0};  // 0.2 to the left through the face at 1, or 1.8 to the right
    CHECK(interpolated(first, last, 0.5).particles.position[0][0] == relative(1.0, 1e-14));
    CHECK(interpolated(first, last, 0.25).particles.position[0][0] == relative(1.05, 1e-14));
    first.box.periodic = last.box.periodic = {false, true, true};
    CHECK(interpolated(first, last, 0.5).particles.position[0][0] == relative(2.0, 1e-14));
}

TEST_CASE("interpolation: particles at rest in a box that shrinks keep their places in it") {
    State last = late();
    for (std::size_t row = 0; row < 2; ++row)
        last.particles.position[row][0] = 1.2 + 0.8 * (early().particles.position[row][0] - 1.0);
    const State state = interpolated(early(), last, 0.5);
    for (std::size_t row = 0; row < 2; ++row)
        CHECK((state.particles.position[row][0] - 1.1) / 1.8 == relative((early().particles.position[row][0] - 1.0) / 2.0, 1e-14));
}

TEST_CASE("interpolation: states of other particles, bonds or faces are refused by name") {
    const auto refusal = [](State last, const char* words) {
        CHECK_THROWS_WITH_AS(interpolated(early(), last, 0.5), doctest::Contains(words), Error);
    };
    State last = late();
    last.particles.id[1] = 4;
    refusal(last, "particle 3 is in one and not in the next");
    last = late();
    last.bonds->pair[0] = {1, 0};
    refusal(last, "bond 0 joins other particles");
    last = late();
    last.bonds.reset();
    refusal(last, "the same bonds");
    last = late();
    last.box.periodic[1] = false;
    refusal(last, "periodic along different axes");
    last = late();
    last.particles.id.pop_back(), last.particles.position.pop_back(), last.particles.radius.pop_back();
    refusal(last, "2 particles, the next 1");
}
