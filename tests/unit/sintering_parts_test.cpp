// sintering_parts_test.cpp: the parts that sintering is made of, each by itself: clusters, candidates, constraints, pairs in
// motion.
#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "linalg/conjugate_gradient.h"
#include "physics/materials.h"
#include "sintering/candidates.h"
#include "sintering/unilateral_constraints.h"
#include "sintering/force_balance.h"
#include "sintering/rigid_clusters.h"
#include "sintering/tangent_solver.h"

using namespace kiln;
using namespace kiln::sintering;

namespace {

constexpr double radius = 1.0;

Box cube(double edge, bool periodic) {
    Box box;
    box.lengths = Vec3::Constant(edge);
    box.periodic = {periodic, periodic, periodic};
    return box;
}

State row_of_spheres(const std::vector<double>& places, bool periodic = false, double edge = 100.0) {
    State state;
    state.box = cube(edge, periodic);
    state.materials = {physics::builtin_material("alumina")};
    for (const double x : places) {
        state.particles.position.emplace_back(x, 5.0, 5.0);
        state.particles.radius.push_back(radius);
        state.particles.material.push_back(0);
        state.particles.id.push_back(static_cast<std::int64_t>(state.particles.id.size()) + 1);
    }
    return state;
}

Motion random_motion(std::size_t particles, unsigned seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> any;
    Motion motion(particles);
    for (double& u : motion.displacement) u = any(random);
    motion.strain = Vec3(any(random), any(random), any(random));
    return motion;
}

double work(const Motion& forces, const Motion& motion) {
    double sum = forces.strain.dot(motion.strain);
    for (std::size_t k = 0; k < motion.displacement.size(); ++k) sum += forces.displacement[k] * motion.displacement[k];
    return sum;
}

}  // namespace

TEST_CASE("rigid clusters: members keep their distances, whatever their nodes and the box do; forces are the transpose") {
    const Box box = cube(10.0, true);
    const std::vector<Vec3> position{{1.0, 1.0, 1.0}, {9.5, 1.0, 1.0}, {5.0, 5.0, 5.0}, {8.0, 1.0, 1.0}};
    const std::vector<Pair> sticking{{0, 1, {-1, 0, 0}}, {1, 3, {0, 0, 0}}};  // 3 - 1 - 0, through a face
    const RigidClusters clusters(box, position, sticking);
    REQUIRE(clusters.nodes() == 2);
    CHECK(clusters.locked() == std::array<bool, 3>{false, false, false});
    const Motion nodes = random_motion(2, 1), motion = clusters.particles(nodes);
    const auto total = [&](std::size_t row, double image) {  // displacement of an image along x, with the strain of the box
        return Vec3(Eigen::Map<const Vec3>(&motion.displacement[3 * row]) +
                    motion.strain.cwiseProduct(position[row] + Vec3(image * 10.0, 0.0, 0.0)));
    };
    CHECK((total(0, 0.0) - total(1, -1.0)).norm() < 1e-14);
    CHECK((total(1, 0.0) - total(3, 0.0)).norm() < 1e-14);
    CHECK((total(0, 0.0) - total(2, 0.0)).norm() > 0.1);
    const Motion forces = random_motion(4, 2);
    CHECK(std::abs(work(clusters.node_forces(forces), nodes) - work(forces, motion)) < 1e-12);
    // The pair 0 - 2 joins the nodes, the pair 0 - 3 (through the face) is inside one.
    const std::vector<Pair> pairs{{0, 2, {0, 0, 0}}, {0, 3, {-1, 0, 0}}, {0, 3, {0, 0, 0}}};
    const std::vector<RigidClusters::NodePair> seen = clusters.node_pairs(pairs);
    REQUIRE(seen.size() == 2);
    CHECK(std::count_if(seen.begin(), seen.end(), [](const auto& one) { return one.row == 0; }) == 1);
    CHECK(std::count_if(seen.begin(), seen.end(), [](const auto& one) { return one.row == 2 && one.pair.i == one.pair.j; }) == 1);
}

TEST_CASE("a cluster that reaches its own image locks the axis, and large clusters are the last nodes") {
    const Box box = cube(4.0, true);
    const std::vector<Vec3> position{{0.0, 0.0, 0.0}, {2.0, 0.0, 0.0}, {0.0, 2.0, 2.0}};
    const RigidClusters chain(box, position, std::vector<Pair>{{0, 1, {0, 0, 0}}, {0, 1, {-1, 0, 0}}});
    CHECK(chain.locked() == std::array<bool, 3>{true, false, false});
    std::vector<Vec3> many;
    std::vector<Pair> tied;
    for (std::int32_t row = 0; row < 40; ++row) {
        many.emplace_back(0.1 * row, 0.0, 0.0);
        if (row > 0 && row < 30) tied.push_back({row - 1, row, {0, 0, 0}});
    }
    const RigidClusters clusters(cube(100.0, false), many, tied);
    REQUIRE(clusters.nodes() == 11);
    CHECK(clusters.node_of()[0] == 10);
    CHECK(clusters.node_of()[39] == 9);
}

TEST_CASE("coarse spaces: one set of clusters for each step in the contrast of the contacts") {
    const std::vector<Vec3> position{{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {2.0, 0.0, 0.0}, {3.0, 0.0, 0.0}};
    const std::vector<Pair> pairs{{0, 1, {0, 0, 0}}, {1, 2, {0, 0, 0}}, {2, 3, {0, 0, 0}}};
    const auto nodes = [&](const std::vector<double>& slowness) {
        std::vector<std::size_t> counts;
        for (const RigidClusters& clusters : coarse_spaces(cube(10.0, false), position, pairs, slowness, 30.0))
            counts.push_back(clusters.nodes());
        return counts;
    };
    CHECK(nodes({1.0, 1.0, 20.0}).empty());
    CHECK(nodes({1.0, 100.0, 100.0}) == std::vector<std::size_t>{2});
    CHECK(nodes({1.0, 100.0, 1e6}) == std::vector<std::size_t>{2, 3});
    CHECK(nodes({0.0, 1.0, 1e6}) == std::vector<std::size_t>{3});  // one that does not touch ties nothing
}

TEST_CASE("sintering body: where one particle runs on, its pairs are listed anew and the others' still hold all that touch") {
    std::vector<double> places;
    for (int sphere = 0; sphere < 200; ++sphere) places.push_back(2.2 * sphere);  // gaps of 0.2
    SinteringBody body(row_of_spheres(places, false, 1000.0), Faces::as_given);
    Motion motion(200);
    for (std::size_t row = 0; row < 200; ++row) {
        motion.displacement[3 * row] = body.particles().id[row] % 2 == 0 ? -0.005 : 0.005;
        if (body.particles().id[row] == 7) motion.displacement[3 * row + 1] = 0.4;
        if (body.particles().id[row] == 8) motion.displacement[3 * row] = -0.55;
    }
    const std::vector<Pair> before = body.pairs();
    for (int step = 0; step < 12; ++step) {  // number 8 passes over number 7, between others that have used up most of their margin
        body.cover(motion);
        body.apply(motion, 1.0 + step, 1473.15);
        const std::vector<Pair> touching = find_pairs(body.box(), body.particles().position, body.particles().radius);
        CHECK(std::ranges::includes(body.pairs(), touching));
        CHECK(std::ranges::is_sorted(body.pairs()));
    }
    CHECK(body.lists() > 3);
    CHECK(body.lists() < 14);
    CHECK(body.pairs() != before);
}

TEST_CASE("candidates: pairs that touch, pairs that a motion brings to touch, and the check that none was left out") {
    const SinteringBody body(row_of_spheres({10.0, 11.99, 14.05, 16.3}), Faces::as_given);  // overlap 0.01, gaps 0.06 and 0.25
    const Kinetics kinetics(body.working(), physics::Schedule::hold(1473.15));
    Candidates candidates(body, kinetics, {});
    const std::vector<double> diffusion{1e-9};
    const Motion rest(4);
    candidates.choose(rest, rest, diffusion);
    CHECK(candidates.touching().size() == 1);
    CHECK(candidates.pairs().size() == 1);
    CHECK(candidates.complete(rest));
    Motion approach(4);
    for (std::size_t row = 0; row < 4; ++row)
        if (body.particles().id[row] == 3) approach.displacement[3 * row] = -0.07;  // closes the gap of 0.06
    CHECK_FALSE(candidates.complete(approach));
    candidates.choose(approach, approach, diffusion);
    CHECK(candidates.pairs().size() == 2);
    CHECK(candidates.touching().size() == 1);
    CHECK(candidates.complete(approach));
    candidates.choose(rest, rest, diffusion, true);  // what was chosen stays
    CHECK(candidates.pairs().size() == 2);
    candidates.choose(rest, rest, diffusion);
    CHECK(candidates.pairs().size() == 1);
    // The bound of the approach: (h^3 + 3 f I/K)^(1/3) - h of the only contact, seen from above.
    const PairStep step = candidates.pair_step(candidates.pairs()[0], diffusion, 1.0);
    const double exact = std::cbrt(std::pow(step.overlap, 3) + 3.0 * step.force / step.cubic) - step.overlap;
    CHECK(candidates.max_isolated_approach(diffusion) >= exact);
    CHECK(candidates.max_isolated_approach(diffusion) < 1.01 * exact);
}

TEST_CASE("before a limit Newton sees the secant towards where its spring holds the force, beyond it the spring") {
    UnilateralConstraints limits;
    limits.reset(2);
    limits.add(1, 0.3, 0.0, 100.0);
    CHECK(limits.tangent(0, 0.0, 5.0) == 0.0);
    CHECK(limits.tangent(1, 0.31, 5.0) == 100.0);
    CHECK(std::abs(limits.tangent(1, 0.25, 5.0) - 5.0 / (0.35 - 0.25)) < 1e-12);  // 5/100 beyond the limit
    CHECK(limits.tangent(1, 0.25, -7.0) == 0.0);  // pulled away from it
    limits.add(1, 0.3, 4.0, 100.0);
    CHECK(std::abs(limits.tangent(1, 0.25, 5.0) - 5.0 / (0.31 - 0.25)) < 1e-12);
}

TEST_CASE("a limit of approach is met exactly by a spring of ordinary stiffness, and lets go when it is pulled") {
    UnilateralConstraints limits;
    limits.reset(2);
    limits.add(1, 0.3, 0.0, 5.0);
    double approach = 0.0;
    const double push = 2.0;  // against a resistance of one: push - approach = reaction
    int passes = 0;
    for (double missed = 2.0; missed > 1.0 && passes < 100; ++passes) {
        for (int newton = 0; newton < 20; ++newton) {
            const double reaction = limits.reaction(1, approach);
            approach += (push - approach - reaction) / (1.0 + limits.tangent(1, approach, push - approach));
        }
        missed = limits.update([&](std::size_t) { return approach; }, [](std::size_t) { return 1e-10; });
    }
    CHECK(passes < 30);
    CHECK(std::abs(approach - 0.3) < 1e-10);
    CHECK(limits.holds(1));
    CHECK(std::abs(limits.reaction(1, approach) - 1.7) < 1e-8);
    CHECK(limits.reaction(0, 1e9) == 0.0);
    limits.update([](std::size_t) { return -5.0; }, [](std::size_t) { return 1e-10; });
    CHECK_FALSE(limits.holds(1));
}

TEST_CASE("the balance of forces: a particle's by what acts on it, and a cluster's that no single particle shows") {
    const std::vector<Vec3> position(101, Vec3::Zero());
    std::vector<Pair> pairs, tied;
    for (std::int32_t row = 0; row < 99; ++row) tied.push_back({row, row + 1, {0, 0, 0}});
    pairs = tied;
    pairs.push_back({99, 100, {0, 0, 0}});
    std::vector<double> exerted(100, 100.0);
    exerted.back() = 1.0;  // the soft contact of the cluster of a hundred
    Motion left(101);
    for (std::size_t row = 0; row < 100; ++row) left.displacement[3 * row] = 0.01;
    const Box box = cube(10.0, false);
    const ContactNetwork network(box, position, pairs);
    CHECK(max_imbalance(network, pairs, exerted, {}, left) < 1e-3);
    left.displacement[3 * 100] = 0.02;  // of what its only contact exerts, 1
    CHECK(unbalanced_particles(network, exerted, 0.01, left) == std::vector<std::size_t>{100});
    CHECK(unbalanced_particles(network, exerted, 0.03, left).empty());
    left.displacement[3 * 100] = 0.0;
    const std::vector<RigidClusters> coarse{{box, position, tied}};
    CHECK(std::abs(max_imbalance(network, pairs, exerted, coarse, left) - 1.0) < 1e-12);
}

TEST_CASE("the error of conjugate gradients is estimated from its own terms") {
    linalg::EnergyError error;
    double estimate = 0.0;
    for (int k = 0; k < 10; ++k) estimate = error.after(std::pow(0.25, k), std::pow(0.25, k + 1));
    CHECK(std::abs(estimate - std::pow(0.25, 10) / 0.75) < 1e-12);  // the sum of the terms to come
}

TEST_CASE("a force that is not a number ends a solve with an error") {
    const std::vector<Vec3> position{{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}};
    const std::vector<Pair> pairs{{0, 1, {0, 0, 0}}};
    const Box box = cube(10.0, false);
    const ContactNetwork network(box, position, pairs);
    TangentSolver<double> solver(box, network, pairs);
    solver.springs().set_direction(0, Vec3::UnitX());
    solver.springs().set(0, 1.0, 0.1);
    solver.factorise(std::vector<Vec3>{Vec3::UnitX()});
    Motion force(2), motion(2);
    force.displacement[0] = std::nan("");
    const auto done = [](const linalg::CgProgress& progress) { return progress.iterations > 10; };
    CHECK_THROWS_WITH_AS(solver.solve(Eigen::Matrix3d::Zero(), force, motion, done), doctest::Contains("not a finite number"),
                         Error);
    force.displacement = {-1.0, 0.0, 0.0, 1.0, 0.0, 0.0};
    solver.springs().set(0, HUGE_VAL, 0.1);
    solver.factorise(std::vector<Vec3>{Vec3::UnitX()});
    CHECK_THROWS_AS(solver.solve(Eigen::Matrix3d::Zero(), force, motion, done), Error);
}

TEST_CASE("pairs slower than a stated fraction of the fastest are rigid, and materials that no particle has do not count") {
    State state = row_of_spheres({10.0, 11.9, 13.8});
    const double delta = physics::diffusion_parameter_of(state.materials[0], 1473.15);
    for (const double fraction : {1e-6, 1e-8, 0.0}) {
        state.materials.resize(1);
        state.materials.push_back(state.materials[0]);
        state.materials[1].name = "slow";
        state.materials[1].diffusion_parameter = fraction * delta;
        state.materials.push_back(state.materials[0]);
        state.materials[2].name = "unused";
        state.materials[2].diffusion_parameter = 1e20 * delta;
        state.particles.material = {0, 0, 1};
        const Kinetics kinetics(state, physics::Schedule::hold(1473.15));
        CHECK(kinetics.any_rigid() == (fraction < Kinetics::rigid_fraction));
        CHECK(kinetics.rigid(kinetics.row(1, 1)) == (fraction < Kinetics::rigid_fraction));
        CHECK_FALSE(kinetics.rigid(kinetics.row(0, 0)));
        CHECK(kinetics.taken_as_rigid().size() == (fraction == 1e-8 ? 2 : 0));  // with itself and with alumina
        CHECK(std::abs(kinetics.fastest() / delta - 1.0) < 1e-15);
    }
}
