// sintering_materials_test.cpp: several materials, rigid inclusions, and the limit of the neck by the dihedral angle.
#include <doctest/doctest.h>

#include <cmath>

#include "tests/physics/sintering_cases.h"

using namespace kiln;
using namespace sintering_cases;

namespace {


Material inclusion() {
    Material material = physics::builtin_material("alumina");
    material.name = "inclusion";
    material.diffusion_parameter = 0.0;
    return material;
}

/// A row of touching spheres along x with the given materials (0 alumina, 1 inclusion) and overlaps of the contacts.
State row_of(const std::vector<std::int32_t>& kinds, const std::vector<double>& overlaps) {
    std::vector<Vec3> positions{Vec3(2e-7, 5e-7, 5e-7)};
    for (const double overlap : overlaps) positions.push_back(positions.back() + Vec3(2.0 * radius - overlap, 0.0, 0.0));
    State state = state_of(positions, std::vector<double>(kinds.size(), radius), Vec3::Constant(2e-6), false);
    state.materials.push_back(inclusion());
    state.particles.material = kinds;
    return state;
}

MaterialPair pair_with(std::optional<double> energy, std::optional<double> delta) {
    MaterialPair pair{};
    pair.materials = {0, 1};
    pair.surface_energy = energy;
    pair.diffusion_parameter = delta;
    return pair;
}

}  // namespace

TEST_CASE("a pair of unlike materials closes by the diffusion and surface energy given for it") {
    State state = row_of({0, 1}, {2e-9});
    state.contacts.push_back(pair_with(0.5 * surface_energy(), 0.2 * diffusion()));
    const double time = 30.0;
    const State end = sintered(state, time);
    CHECK(deviation(2.0 * radius - distance(end, 0, 1), pair_law(2e-9, 0.5 * radius, 0.1 * time)) < 1e-6);
}

TEST_CASE("particles joined by a contact that does not diffuse move together, and their contacts with the others sinter") {
    State state = row_of({0, 1, 1, 0}, {2e-9, 1e-9, 2e-9});
    state.contacts.push_back(pair_with(std::nullopt, diffusion()));
    const double time = 30.0;
    const State end = sintered(state, time);
    CHECK(std::abs(distance(end, 1, 2) - distance(state, 1, 2)) < 1e-12 * radius);
    CHECK(deviation(2.0 * radius - distance(end, 0, 1), pair_law(2e-9, 0.5 * radius, time)) < 1e-6);
    CHECK(deviation(2.0 * radius - distance(end, 2, 3), pair_law(2e-9, 0.5 * radius, time)) < 1e-6);
}

TEST_CASE("rigid particles that meet stop at touch and stay together") {
    // A ring of four: two inclusions with a gap between them, drawn together by alumina on both sides.
    const double gap = 4e-9, time = 400.0;
    const Vec3 middle = Vec3::Constant(5e-7), half(0.5 * (2.0 * radius + gap), 0.0, 0.0);
    const double height = std::sqrt(std::pow(2.0 * radius - 1e-9, 2) - half.squaredNorm());
    State state = state_of({middle - half, middle + half, middle + Vec3(0, height, 0), middle - Vec3(0, height, 0)},
                           std::vector<double>(4, radius), Vec3::Constant(2e-6), false);
    state.materials.push_back(inclusion());
    state.particles.material = {1, 1, 0, 0};
    state.contacts.push_back(pair_with(std::nullopt, diffusion()));
    const State end = sintered(state, time);
    CHECK(std::abs(distance(end, 0, 1) - 2.0 * radius) < 1e-5 * radius);
    CHECK(distance(end, 0, 2) < 2.0 * radius - 1e-8);
    CHECK(deviation(distance(end, 0, 2), distance(end, 1, 3)) < 1e-9);
}

TEST_CASE("rigid inclusions in a sintering matrix: they keep their distances where they touch, and slow the whole down") {
    State plain = random_packing(300, 0.5, 1.0), filled = plain;
    filled.materials.push_back(inclusion());
    for (std::size_t row = 0; row < filled.particles.size(); row += 5) filled.particles.material[row] = 1;
    filled.contacts.push_back(pair_with(std::nullopt, diffusion()));
    const double time = 60.0;
    const State without = sintered(plain, time), with = sintered(filled, time);
    CHECK(relative_density(with) > relative_density(filled));
    CHECK(relative_density(with) < relative_density(without));
    const auto deepest = [](const State& state) {  // overlap of two inclusions over the radius
        double most = 0.0;
        for (const Pair& pair : find_pairs(state.box, state.particles.position, state.particles.radius)) {
            const auto i = static_cast<std::size_t>(pair.i), j = static_cast<std::size_t>(pair.j);
            if (state.particles.material[i] == 0 || state.particles.material[j] == 0) continue;
            most = std::max(most, 2.0 * radius - pair_vector(state.box, state.particles.position, pair).norm());
        }
        return most / radius;
    };
    CHECK(deepest(with) < deepest(filled) + 1e-5);
    CHECK(deepest(without) == 0.0);  // no inclusions there
}

TEST_CASE("a box that a chain of inclusions spans does not strain along it") {
    State state = state_of({{0.0, 0.0, 0.0}}, {radius}, Vec3(2.0 * radius, 2.0 * radius, 2.0 * radius - 1e-9), true);
    state.materials = {inclusion(), physics::builtin_material("alumina")};
    state.particles.position.emplace_back(radius, radius, radius);
    state.particles.radius.push_back(0.8 * radius);
    state.particles.material = {0, 1};
    state.particles.id = {1, 2};
    state.box.lengths[0] = state.box.lengths[1] = 2.1 * radius;
    MaterialPair pair = pair_with(std::nullopt, diffusion());
    state.contacts.push_back(pair);
    sintering::ImplicitSintering sintering(state, settings());
    while (sintering.time() < 5.0) REQUIRE(sintering.advance(5.0, endless).converged);
    CHECK(sintering.state().box.lengths[2] == 2.0 * radius - 1e-9);
    CHECK(sintering.state().box.lengths[0] < 2.1 * radius);
}

TEST_CASE("the overlap stops where the neck meets the dihedral angle") {
    State state = row_of({0, 0}, {1e-9});
    state.materials[0].dihedral_angle = 2.0 * std::numbers::pi / 3.0;
    state.materials.resize(1);
    const double neck = std::sin(std::numbers::pi / 3.0) * radius, limit = neck * neck / (2.0 * radius);  // a^2 = 2 R h
    const double meets = (std::pow(limit, 3) - 1e-27) * 0.5 * radius / (3.375 * diffusion() * surface_energy());
    CHECK(deviation(2.0 * radius - distance(sintered(state, 0.5 * meets), 0, 1), pair_law(1e-9, 0.5 * radius, 0.5 * meets)) < 1e-6);
    CHECK(deviation(2.0 * radius - distance(sintered(state, 3.0 * meets), 0, 1), limit) < 1e-5);
}

TEST_CASE("nothing sinters where no pair of materials diffuses") {
    State state = row_of({1, 1}, {1e-9});
    state.materials[0] = inclusion();
    CHECK_THROWS_WITH_AS(sintering::ImplicitSintering(state, settings()), doctest::Contains("nothing can sinter"), Error);
}
