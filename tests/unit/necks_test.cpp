// necks_test.cpp: geometry of necks, volume of their union with the spheres, and the factor that makes it that of the mass.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "bonding/bondify.h"
#include "bonding/necks.h"
#include "bonding/union_volume.h"
#include "physics/neck.h"
#include "physics/sinter_contact.h"
#include "tests/physics/relative.h"
#include "tests/unit/spheres.h"

using namespace kiln;
using namespace kiln::bonding;
using kiln::test::make_state;
using kiln::test::relative;
using std::numbers::pi;

namespace {

/// Spheres of radii between one and twice that on a disturbed cubic grid, periodic.
State make_packing(int side, unsigned seed, double spacing) {
    std::mt19937 random(seed);
    const auto uniform = [&](double low, double high) { return low + (high - low) * static_cast<double>(random()) / 4294967296.0; };
    std::vector<Vec3> position;
    std::vector<double> radius;
    for (int x = 0; x < side; ++x)
        for (int y = 0; y < side; ++y)
            for (int z = 0; z < side; ++z) {
                position.push_back(spacing * Vec3(x + uniform(-0.2, 0.2), y + uniform(-0.2, 0.2), z + uniform(-0.2, 0.2)));
                radius.push_back(uniform(1.0, 2.0));
            }
    return make_state(position, radius, side * spacing, true);
}

std::vector<Pair> pairs_of(const State& state) {
    return find_pairs(state.box, state.particles.position, state.particles.radius);
}

UnionVolume volume_of(const State& state, const std::vector<Pair>& pairs) {
    return {state.box, state.particles.position, state.particles.radius, pairs};
}

/// Volume of the union by a grid of points over the periodic box, image by image.
double counted_volume(const State& state, const std::vector<Pair>& pairs, const std::vector<double>& neck, int grid) {
    const double edge = state.box.lengths[0], step = edge / grid;
    std::vector<char> solid(static_cast<std::size_t>(grid * grid * grid), 0);
    const auto mark = [&](const Vec3& centre, double reach, const auto& inside) {
        std::array<int, 3> low, high;
        for (int axis = 0; axis < 3; ++axis) {
            low[static_cast<std::size_t>(axis)] = static_cast<int>(std::floor((centre[axis] - reach) / step));
            high[static_cast<std::size_t>(axis)] = static_cast<int>(std::ceil((centre[axis] + reach) / step));
        }
        const auto wrapped = [&](int k) { return ((k % grid) + grid) % grid; };
        for (int x = low[0]; x <= high[0]; ++x)
            for (int y = low[1]; y <= high[1]; ++y)
                for (int z = low[2]; z <= high[2]; ++z)
                    if (inside(Vec3(step * (Vec3(x, y, z) + Vec3::Constant(0.5)) - centre)))
                        solid[static_cast<std::size_t>((wrapped(x) * grid + wrapped(y)) * grid + wrapped(z))] = 1;
    };
    for (std::size_t row = 0; row < state.particles.size(); ++row) {
        const double r = state.particles.radius[row];
        mark(state.particles.position[row], r, [&](const Vec3& p) { return p.squaredNorm() < r * r; });
    }
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        const Vec3 vector = pair_vector(state.box, state.particles.position, pairs[k]), n = vector.normalized();
        const double d = vector.norm(), a = neck[k];
        mark(state.particles.position[static_cast<std::size_t>(pairs[k].i)], d + a, [&](const Vec3& p) {
            const double along = p.dot(n);
            return along > 0.0 && along < d && p.squaredNorm() - along * along < a * a;
        });
    }
    return static_cast<double>(std::ranges::count(solid, 1)) * step * step * step;
}

/// A factor times the radius of the sintering law, m.
double coble(double factor, double distance, double radius1, double radius2) {
    const double overlap = radius1 + radius2 - distance;
    return factor * std::sqrt(physics::contact_radius_squared(overlap, physics::reduced_radius(radius1, radius2)));
}

}  // namespace

TEST_CASE("necks: Coble's radius times a factor, within the limit, no narrower than where the spheres meet") {
    const double d = 1.9, h = 0.1;
    CHECK(physics::neck_radius(coble(1.0, d, 1.0, 1.0), d, 1.0, 1.0, 1.0) == relative(std::sqrt(2.0 * h), 1e-12));
    CHECK(physics::neck_radius(coble(1.2, d, 1.0, 1.0), d, 1.0, 1.0, 1.0) == relative(1.2 * std::sqrt(2.0 * h), 1e-12));
    CHECK(physics::neck_radius(coble(1.0, 2.9, 1.0, 2.0), 2.9, 1.0, 2.0, 1.0) == relative(std::sqrt(4.0 * 2.0 / 3.0 * h), 1e-12));
    CHECK(physics::neck_radius(coble(1.0, d, 1.0, 1.0), d, 1.0, 1.0, 0.4) == 0.4);
    const double circle = std::sqrt(1.0 - d * d / 4.0);
    CHECK(physics::meeting_radius(d, 1.0, 1.0) == relative(circle, 1e-12));
    CHECK(physics::neck_radius(coble(0.1, d, 1.0, 1.0), d, 1.0, 1.0, 1.0) == relative(circle, 1e-12));
    CHECK(physics::neck_length(d, 1.0, 1.0, circle) == 0.0);
    CHECK(physics::neck_length(d, 1.0, 1.0, 0.45) == relative(d - 2.0 * std::sqrt(1.0 - 0.45 * 0.45), 1e-12));
    // The circle of two unequal spheres, by Pythagoras from both.
    const double plane = physics::meeting_plane(2.6, 1.0, 2.0), meeting = physics::meeting_radius(2.6, 1.0, 2.0);
    CHECK(plane * plane + meeting * meeting == relative(1.0, 1e-12));
    CHECK((2.6 - plane) * (2.6 - plane) + meeting * meeting == relative(4.0, 1e-12));
    CHECK(physics::meeting_radius(3.0, 1.0, 2.0) == 0.0);
    // A sphere that is sunk into another beyond its centre meets it as a whole.
    CHECK(physics::neck_radius(coble(1.0, 1.5, 1.0, 2.0), 1.5, 1.0, 2.0, 0.8) == 1.0);
    CHECK(physics::neck_length(1.5, 1.0, 2.0, 1.0) == 0.0);
    Material material;
    CHECK(std::isinf(physics::neck_limit(material)));
    material.dihedral_angle = 2.0 * pi / 3.0;
    CHECK(physics::neck_limit(material) == relative(std::sqrt(3.0) / 2.0, 1e-12));
}

TEST_CASE("necks: the union of two spheres and their neck is exact, free or through a face of the box") {
    for (const auto& [r1, r2, d] : {std::tuple{1.0, 1.0, 1.9}, std::tuple{1.0, 2.0, 2.8}, std::tuple{0.1, 2.0, 2.09}}) {
        const double t = physics::meeting_plane(d, r1, r2), a = std::min({0.7 * r1, 0.7 * r2});
        const auto cap = [](double r, double height) { return pi * height * height * (r - height / 3.0); };
        const double lens = cap(r1, r1 - t) + cap(r2, r2 - d + t);
        const double spheres = sphere_volume(r1) + sphere_volume(r2) - lens;
        // Cylinder between the two circles of radius a, less what of it is in the spheres.
        const double s1 = std::sqrt(r1 * r1 - a * a), s2 = std::sqrt(r2 * r2 - a * a);
        const auto slab = [](double r, double from, double to) {
            return pi * (r * r * (to - from) - (to * to * to - from * from * from) / 3.0);
        };
        const double ring = pi * a * a * (d - s1 - s2) - slab(r1, s1, t) - slab(r2, s2, d - t);
        for (const bool periodic : {false, true}) {
            const State state = make_state({Vec3(0.1, 5, 5), Vec3(periodic ? 10.1 - d : 0.1 + d, 5, 5)}, {r1, r2}, 10.0, periodic);
            const std::vector<Pair> pairs = pairs_of(state);
            REQUIRE(pairs.size() == 1);
            UnionVolume volume = volume_of(state, pairs);
            CHECK(volume.spheres().value == relative(spheres, 1e-12));
            CHECK(volume.spheres().error == 0.0);
            const VolumeEstimate all = volume.with_necks(std::vector{a});
            CHECK(all.value == relative(spheres + ring, 1e-12));
            CHECK(all.error == 0.0);
        }
    }
}

TEST_CASE("necks: a sphere inside another adds nothing, and one sunk in beyond its centre no neck") {
    for (const double d : {0.5, 1.7}) {
        const State state = make_state({Vec3(5, 5, 5), Vec3(5 + d, 5, 5)}, {2.0, 1.0}, 10.0, false);
        const std::vector<Pair> pairs = pairs_of(state);
        UnionVolume volume = volume_of(state, pairs);
        const VolumeEstimate all = volume.with_necks(std::vector{physics::neck_radius(coble(1.0, d, 2.0, 1.0), d, 2.0, 1.0, 1.0)});
        CHECK(all.value == volume.spheres().value);
        if (d + 1.0 <= 2.0) CHECK(all.value == relative(sphere_volume(2.0), 1e-12));
    }
}

TEST_CASE("necks: over a gap a neck is a cylinder less the caps that reach into it; a record makes it a contact") {
    const double d = 2.2, a = 0.5, s = std::sqrt(1.0 - a * a), h = 1.0 - s;
    State state = make_state({Vec3(5, 5, 5), Vec3(5 + d, 5, 5)}, {1.0, 1.0}, 10.0, false);
    CHECK(physics::recorded_contacts(state).pairs.empty());
    state.necks = kiln::Necks{{{{1, 0}}}, {{{0, 0, 0}}}, {a}, {}};
    const physics::RecordedContacts contacts = physics::recorded_contacts(state);
    REQUIRE(contacts.pairs.size() == 1);
    CHECK(contacts.overlap.front() == relative(a * a / 2.0, 1e-12));
    UnionVolume volume = volume_of(state, contacts.pairs);
    const double expected = 2.0 * sphere_volume(1.0) + pi * a * a * (d - 2.0 * s) - 2.0 * pi * h * h * (1.0 - h / 3.0);
    CHECK(volume.with_necks(std::vector{a}).value == relative(expected, 1e-12));
    state.necks->radius.front() = 0.0;  // the two do not touch, whatever their spheres do
    state.particles.position[1] = Vec3(6.9, 5, 5);
    CHECK(physics::recorded_contacts(state).pairs.empty());
}

TEST_CASE("necks: where spheres and necks share space, points find the same as a fine grid, within the error they tell") {
    for (const unsigned seed : {1u, 2u}) {
        const State state = make_packing(3, seed, 2.4);
        const std::vector<Pair> pairs = pairs_of(state);
        std::vector<double> neck;
        for (const Pair& pair : pairs) {
            const double r1 = state.particles.radius[static_cast<std::size_t>(pair.i)];
            const double r2 = state.particles.radius[static_cast<std::size_t>(pair.j)];
            const double d = pair_vector(state.box, state.particles.position, pair).norm();
            neck.push_back(physics::neck_radius(coble(1.3, d, r1, r2), d, r1, r2, 0.9 * std::min(r1, r2)));
        }
        UnionVolume volume = volume_of(state, pairs);
        const VolumeEstimate all = volume.with_necks(neck);
        const double solid = particle_volume(state.particles);
        CHECK(volume.spheres().value < 0.9 * solid);  // lenses are shared by three and more
        CHECK(all.value > 1.02 * volume.spheres().value);
        CHECK(all.error > 0.0);
        CHECK(all.error < 3e-4 * all.value);
        const int grid = 160;
        const double step = state.box.lengths[0] / grid, grid_error = 2e-4 * all.value;
        CHECK(step < 0.05);
        CHECK(std::abs(volume.spheres().value - counted_volume(state, pairs, std::vector(pairs.size(), 0.0), grid)) <
              3.0 * volume.spheres().error + grid_error);
        CHECK(std::abs(all.value - counted_volume(state, pairs, neck, grid)) < 3.0 * all.error + grid_error);
    }
}

TEST_CASE("necks: spheres touching their own images in a box of one particle") {
    const double edge = 1.8, a = 0.6, s = std::sqrt(1.0 - a * a), height = 1.0 - edge / 2.0;
    const State state = make_state({Vec3(0.3, 0.4, 0.5)}, {1.0}, edge, true);
    const std::vector<Pair> pairs = pairs_of(state);
    REQUIRE(pairs.size() == 3);
    UnionVolume volume = volume_of(state, pairs);
    const double spheres = sphere_volume(1.0) - 6.0 * pi * height * height * (1.0 - height / 3.0);
    CHECK(volume.spheres().value == relative(spheres, 1e-12));
    const double w = edge / 2.0 - s, ring = pi * w * w * (edge / 2.0 + 2.0 * s) / 3.0;
    CHECK(volume.with_necks(std::vector(3, a)).value == relative(spheres + 6.0 * ring, 1e-12));
}

TEST_CASE("necks: one factor makes the union as large as the mass; the law's own necks have factor one") {
    const State state = make_packing(5, 3, 2.75);
    const std::vector<Pair> pairs = pairs_of(state);
    const double mass = particle_volume(state.particles);
    const NeckSizes by_mass = neck_sizes(state, physics::recorded_contacts(state), bonding::Necks::mass);
    CHECK(by_mass.fills);
    CHECK(std::abs(by_mass.union_volume / mass - 1.0) <= 1e-5);
    CHECK(by_mass.union_error < 3e-4 * mass);
    UnionVolume volume = volume_of(state, pairs);
    CHECK(volume.with_necks(by_mass.radius).value == by_mass.union_volume);

    const NeckSizes law = neck_sizes(state, physics::recorded_contacts(state), bonding::Necks::law);
    CHECK(law.factor == 1.0);
    std::size_t checked = 0;
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        const double r1 = state.particles.radius[static_cast<std::size_t>(pairs[k].i)];
        const double r2 = state.particles.radius[static_cast<std::size_t>(pairs[k].j)];
        const double h = r1 + r2 - pair_vector(state.box, state.particles.position, pairs[k]).norm();
        const double a = std::sqrt(physics::contact_radius_squared(h, physics::reduced_radius(r1, r2)));
        if (a >= std::min(r1, r2)) continue;
        CHECK(law.radius[k] == relative(a, 1e-12));
        ++checked;
    }
    CHECK(checked > pairs.size() / 2);
}

TEST_CASE("necks: the dihedral angle limits them, and where no factor fills the mass the nearest is told") {
    State state = make_packing(4, 4, 2.4);
    const std::vector<Pair> pairs = pairs_of(state);
    state.materials.front().dihedral_angle = pi / 3.0;  // a/r at most 1/2
    state.materials.emplace_back();
    for (std::size_t row = 0; row < state.particles.size(); row += 3) state.particles.material[row] = 1;
    const NeckSizes sizes = neck_sizes(state, physics::recorded_contacts(state), bonding::Necks::mass);
    CHECK_FALSE(sizes.fills);
    CHECK(sizes.factor == max_neck_factor);
    CHECK(sizes.union_volume < particle_volume(state.particles));
    std::size_t limited = 0, unlimited = 0;
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        const auto i = static_cast<std::size_t>(pairs[k].i), j = static_cast<std::size_t>(pairs[k].j);
        const double r1 = state.particles.radius[i], r2 = state.particles.radius[j], smaller = std::min(r1, r2);
        const double d = pair_vector(state.box, state.particles.position, pairs[k]).norm();
        const bool free = state.particles.material[i] == 1 && state.particles.material[j] == 1;
        if (!free) CHECK(sizes.radius[k] <= std::max(0.5 * smaller * (1.0 + 1e-12), physics::meeting_radius(d, r1, r2)));
        limited += sizes.radius[k] >= (free ? 1.0 : 0.5) * smaller * (1.0 - 1e-12);
        unlimited += free && sizes.radius[k] > 0.5 * smaller;
    }
    CHECK(limited == sizes.limited);
    CHECK(unlimited > 0);
}

TEST_CASE("necks: bondify keeps the particles and all their mass, and gives every contact a bond") {
    State state = make_packing(5, 5, 2.9);
    const State before = state;
    Options options;
    options.method = bonding::Method::necks;
    const Summary summary = bonding::bondify(state, options);
    CHECK(state.particles.radius == before.particles.radius);
    CHECK(relative_density(state) == relative_density(before));
    CHECK(summary.bonds == pairs_of(before).size());
    CHECK(summary.solid_fraction == relative(relative_density(before), 1e-14));
    CHECK(summary.fills);
    CHECK(summary.union_fraction == relative(summary.solid_fraction, 1e-5));
    for (std::size_t bond = 0; bond < state.bonds->size(); ++bond) {
        const double r1 = state.particles.radius[static_cast<std::size_t>(state.bonds->pair[bond][0])];
        const double r2 = state.particles.radius[static_cast<std::size_t>(state.bonds->pair[bond][1])];
        const double d = bond_vector(state, *state.bonds, bond).norm(), a = state.bonds->radius[bond];
        CHECK(state.bonds->volume[bond] == 0.0);
        CHECK(state.bonds->length[bond] == physics::neck_length(d, r1, r2, a));
        CHECK(state.bonds->length[bond] >= 0.0);
    }
    CHECK_THROWS_AS(bonding::bondify(state, options, {.stop = [] { return true; }, .progress = {}}), Interrupted);

    State apart = make_state({Vec3(1, 1, 1), Vec3(4, 4, 4)}, {1.0, 1.0}, 6.0, true);
    CHECK(bonding::bondify(apart, options).bonds == 0);
    CHECK(apart.bonds->size() == 0);
}
