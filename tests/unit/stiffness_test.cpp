// stiffness_test.cpp: linear solves of the network beside sums of pair forces in double, with walls, coarse spaces and strains.
#include <doctest/doctest.h>

#include <algorithm>
#include <random>

#include "sintering/few_particles.h"
#include "sintering/tangent_solver.h"

using namespace kiln;
using namespace kiln::sintering;

namespace {

/// A random packing with random contact stiffness, its network across several chunks and through the faces of the box.
struct Sample {
    Box box;
    std::vector<Vec3> position;
    std::vector<Pair> pairs;

    explicit Sample(std::size_t particles, double reach) {
        std::mt19937_64 random(7);
        std::uniform_real_distribution<double> place(0.0, 1.0);
        box.lengths = Vec3(1.0, 1.1, 0.9);
        box.periodic = {true, true, true};
        for (std::size_t row = 0; row < particles; ++row)
            position.push_back(box.lengths.cwiseProduct(Vec3(place(random), place(random), place(random))));
        pairs = find_pairs(box, position, std::vector<double>(particles, reach));
    }
};

double normal_of(std::size_t row) { return 1.0 + 0.3 * static_cast<double>(row % 7); }
double tangential_of(std::size_t row) { return 0.02 + 0.01 * static_cast<double>(row % 5); }

template <typename Real>
void fill(linalg::EdgeStiffness<Real>& springs, const ContactNetwork& network, const Sample& sample) {
    for (std::size_t entry = 0; entry < network.pair.size(); ++entry) {
        const auto row = static_cast<std::size_t>(network.pair[entry]);
        springs.set_direction(entry, pair_vector(sample.box, sample.position, sample.pairs[row]).normalized());
        springs.set(entry, normal_of(row), tangential_of(row));
    }
}

Motion any_motion(std::size_t particles, unsigned seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> any;
    Motion motion(particles);
    for (double& u : motion.displacement) u = any(random);
    motion.strain = Vec3(any(random), any(random), any(random));
    return motion;
}

/// Forces of a motion, summed up pair by pair.
Motion forces_of(const Sample& sample, const Motion& motion) {
    Motion forces(sample.position.size());
    for (std::size_t row = 0; row < sample.pairs.size(); ++row) {
        const auto i = static_cast<std::size_t>(sample.pairs[row].i), j = static_cast<std::size_t>(sample.pairs[row].j);
        const Vec3 l = pair_vector(sample.box, sample.position, sample.pairs[row]), n = l.normalized();
        const Vec3 du = Eigen::Map<const Vec3>(&motion.displacement[3 * j]) - Eigen::Map<const Vec3>(&motion.displacement[3 * i]) +
                        motion.strain.cwiseProduct(l);
        const Vec3 f = tangential_of(row) * du + (normal_of(row) - tangential_of(row)) * n.dot(du) * n;
        Eigen::Map<Vec3>(&forces.displacement[3 * i]) -= f;
        Eigen::Map<Vec3>(&forces.displacement[3 * j]) += f;
        forces.strain += f.cwiseProduct(l);
    }
    return forces;
}

std::vector<Vec3> branches_of(const Sample& sample) {
    std::vector<Vec3> branch;
    for (const Pair& pair : sample.pairs) branch.push_back(pair_vector(sample.box, sample.position, pair));
    return branch;
}

/// Solves for the forces of a random motion; the energy of what is missing of the motion over that of the motion.
template <typename Real>
double missing(const Sample& sample, std::span<const RigidClusters> coarse, const Eigen::Matrix3d& allowed, double goal,
               linalg::CgProgress& progress) {
    const ContactNetwork network(sample.box, sample.position, sample.pairs);
    TangentSolver<Real> solver(sample.box, network, sample.pairs, coarse);
    fill(solver.springs(), network, sample);
    solver.factorise(branches_of(sample));
    Motion motion = any_motion(sample.position.size(), 1), found(sample.position.size());
    project(motion, allowed);
    Motion forces = forces_of(sample, motion);
    project(forces, allowed);
    progress = solver.solve(allowed, forces, found, [&](const linalg::CgProgress& so_far) {
        return so_far.iterations == 500 || (so_far.iterations > 0 && so_far.relative_error() < goal);
    });
    const double energy = dot(network, motion, forces);
    CHECK(std::abs(progress.energy / energy - 1.0) < 10.0 * goal);
    add(network, -1.0, motion, found);
    return std::sqrt(dot(network, found, forces_of(sample, found)) / energy);
}

}  // namespace

TEST_CASE_TEMPLATE("a solve finds the motion whose forces, summed up pair by pair, it was given; strains and faces included", Real,
                   float, double) {
    const double goal = sizeof(Real) == 4 ? 1e-4 : 1e-9;
    const Sample sample(5000, 0.05);
    REQUIRE(ContactNetwork(sample.box, sample.position, sample.pairs).chunks().size() == 3);
    std::vector<Pair> tied;
    for (std::size_t row = 0; row < sample.pairs.size(); row += 5) tied.push_back(sample.pairs[row]);
    const std::vector<RigidClusters> coarse{{sample.box, sample.position, tied}};
    linalg::CgProgress alone, helped;
    for (const Vec3& free : {Vec3(1.0, 1.0, 1.0), Vec3(1.0, 0.0, 1.0), Vec3(0.0, 0.0, 0.0)}) {
        CAPTURE(free.transpose());
        CHECK(missing<Real>(sample, {}, free.asDiagonal(), goal, alone) < 5.0 * goal);
        CHECK(alone.iterations < 500);
        CHECK(missing<Real>(sample, coarse, free.asDiagonal(), goal, helped) < 5.0 * goal);
        CHECK(helped.iterations < 500);
    }
}

TEST_CASE("few particles and three rings of neighbours find their motion, and all others stay where they are") {
    const Sample sample(5000, 0.035);
    const std::vector<std::size_t> particles{17, 2500, 4000};
    std::vector<int> distance(sample.position.size(), 9);
    for (const std::size_t row : particles) distance[row] = 0;
    for (int ring = 0; ring < 3; ++ring)
        for (const Pair& pair : sample.pairs) {
            int& i = distance[static_cast<std::size_t>(pair.i)];
            int& j = distance[static_cast<std::size_t>(pair.j)];
            j = i == ring ? std::min(j, ring + 1) : j;
            i = j == ring ? std::min(i, ring + 1) : i;
        }
    const auto moving = std::ranges::count_if(distance, [](int away) { return away <= 3; });
    REQUIRE(moving > 50);
    REQUIRE(moving < 1000);
    Motion motion = any_motion(sample.position.size(), 2);
    motion.strain.setZero();
    for (std::size_t k = 0; k < motion.displacement.size(); ++k)
        if (distance[k / 3] > 3) motion.displacement[k] = 0.0;
    const Motion forces = forces_of(sample, motion);
    const ContactNetwork network(sample.box, sample.position, sample.pairs);
    linalg::EdgeStiffness<float> springs(network.pair.size());
    fill(springs, network, sample);
    Motion found = any_motion(sample.position.size(), 3);
    relax_few(network, [&](std::size_t entry) { return springs.spring(entry).block(); }, particles, forces, found);
    CHECK(found.strain.isZero(0.0));
    for (std::size_t k = 0; k < found.displacement.size(); ++k)
        if (distance[k / 3] > 3) CHECK(found.displacement[k] == 0.0);
    add(network, -1.0, motion, found);
    CHECK(std::sqrt(dot(network, found, forces_of(sample, found)) / dot(network, motion, forces)) < 0.06);
}

TEST_CASE("in a box smaller than its particles a particle's own image resists strains") {
    Sample sample(0, 1.0);
    sample.box.lengths = Vec3(1.0, 1.0, 1.2);
    sample.position = {Vec3(0.1, 0.2, 0.3), Vec3(0.5, 0.6, 0.8)};
    sample.pairs = find_pairs(sample.box, sample.position, std::vector<double>(2, 0.61));
    REQUIRE(std::ranges::count_if(sample.pairs, [](const Pair& pair) { return pair.i == pair.j; }) > 0);
    linalg::CgProgress progress;
    CHECK(missing<double>(sample, {}, Eigen::Matrix3d::Identity(), 1e-9, progress) < 1e-8);
    CHECK(progress.iterations <= 10);  // nine unknowns, and rounding
}

TEST_CASE("on a chain of contacts the preconditioner is the inverse: conjugate gradients end after one iteration") {
    Sample sample(0, 1.0);
    sample.box.lengths = Vec3::Constant(100.0);
    std::mt19937_64 random(3);
    std::normal_distribution<double> any;
    for (int row = 0; row < 40; ++row)
        sample.position.push_back(Vec3::Constant(50.0) + Vec3(row, 0.2 * any(random), 0.2 * any(random)));
    for (std::int32_t row = 1; row < 40; ++row) sample.pairs.push_back({row - 1, row, {}});
    const ContactNetwork network(sample.box, sample.position, sample.pairs);
    TangentSolver<float> solver(sample.box, network, sample.pairs);
    fill(solver.springs(), network, sample);
    solver.factorise(std::vector<Vec3>(sample.pairs.size(), Vec3::Zero()));
    Motion force(40), motion(40);
    for (std::size_t k = 3; k < force.displacement.size(); ++k) {  // no net force on the whole, which hangs on nothing
        force.displacement[k] = any(random);
        force.displacement[k % 3] -= force.displacement[k];
    }
    const double rounding = 1e-2;  // single precision times the condition of the chain, 40^2 times normal over tangential stiffness
    const linalg::CgProgress solve = solver.solve(Eigen::Matrix3d::Zero(), force, motion, [&](const linalg::CgProgress& progress) {
        return progress.iterations == 50 || (progress.iterations > 0 && progress.relative_error() < rounding);
    });
    CHECK(solve.iterations == 1);
    CHECK(solve.relative_error() < rounding);
}
