// stiffness_test.cpp: the product in single precision beside sums of pair forces in double, its symmetry, and its preconditioner.
#include <doctest/doctest.h>

#include <limits>
#include <random>

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
void fill(Stiffness<Real>& stiffness, const ContactNetwork& network, const Sample& sample) {
    for (std::size_t entry = 0; entry < network.pair.size(); ++entry) {
        const auto row = static_cast<std::size_t>(network.pair[entry]);
        stiffness.set_direction(entry, pair_vector(sample.box, sample.position, sample.pairs[row]).normalized());
        stiffness.set(entry, normal_of(row), tangential_of(row));
    }
}

template <typename Real>
QuadMotion<Real> random_motion(std::size_t particles, unsigned seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> any;
    QuadMotion<Real> motion(particles);
    for (Quad<Real>& u : motion.displacement) u = linalg::quad<Real>(any(random), any(random), any(random));
    motion.strain = Vec3(any(random), any(random), any(random));
    return motion;
}

template <typename Real>
QuadMotion<Real> product(const Stiffness<Real>& stiffness, const QuadMotion<Real>& motion) {
    QuadMotion<Real> forces(motion.displacement.size());
    std::vector<Quad<Real>> total(motion.displacement.size());
    const std::size_t chunks = stiffness.network().chunks().size();
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) stiffness.displace(chunk, motion, total);
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) forces.strain += stiffness.multiply(chunk, motion.strain, total, forces);
    return forces;
}

template <typename Real>
double dot(const QuadMotion<Real>& a, const QuadMotion<Real>& b) {
    linalg::WideQuad sums;
    for (std::size_t row = 0; row < a.displacement.size(); ++row)
        linalg::add_product(a.displacement[row], b.displacement[row], sums);
    return sums.sum() + a.strain.dot(b.strain);
}

}  // namespace

TEST_CASE_TEMPLATE("the stiffness of a network times a motion is the sum of its pairs' forces, and its spare places stay empty",
                   Real, float, double) {
    const Sample sample(5000, 0.05);  // three chunks
    const ContactNetwork network(sample.box, sample.position, sample.pairs);
    Stiffness<Real> stiffness(network);
    fill(stiffness, network, sample);
    const QuadMotion<Real> motion = random_motion<Real>(sample.position.size(), 1);
    const QuadMotion<Real> forces = product(stiffness, motion);
    std::vector<Vec3> expected(sample.position.size(), Vec3::Zero());
    Vec3 strain_work = Vec3::Zero();
    using linalg::vector;
    double scale = 0.0;
    for (std::size_t row = 0; row < sample.pairs.size(); ++row) {
        const auto i = static_cast<std::size_t>(sample.pairs[row].i), j = static_cast<std::size_t>(sample.pairs[row].j);
        const Vec3 l = pair_vector(sample.box, sample.position, sample.pairs[row]), n = l.normalized();
        const Vec3 du = vector(motion.displacement[j]) - vector(motion.displacement[i]) + motion.strain.cwiseProduct(l);
        const Vec3 f = tangential_of(row) * du + (normal_of(row) - tangential_of(row)) * n.dot(du) * n;
        expected[i] -= f;
        expected[j] += f;
        strain_work += f.cwiseProduct(l);
        scale = std::max(scale, f.norm());
    }
    REQUIRE(network.chunks().size() == 3);
    double worst = 0.0;
    for (std::size_t row = 0; row < expected.size(); ++row) {
        worst = std::max(worst, (vector(forces.displacement[row]) - expected[row]).norm());
        REQUIRE(forces.displacement[row].lanes[3] == Real{0});
    }
    const double rounding = std::numeric_limits<Real>::epsilon();
    CHECK(worst < 20.0 * rounding * scale);
    CHECK((forces.strain - strain_work).norm() < 100.0 * rounding * strain_work.norm());
}

TEST_CASE("the stiffness is symmetric and its preconditioner too, and positive") {
    const Sample sample(5000, 0.05);
    const ContactNetwork network(sample.box, sample.position, sample.pairs);
    Stiffness<float> stiffness(network);
    fill(stiffness, network, sample);
    const QuadMotion<float> x = random_motion<float>(sample.position.size(), 1),
                            y = random_motion<float>(sample.position.size(), 2);
    const double scale = std::sqrt(dot(x, product(stiffness, x)) * dot(y, product(stiffness, y)));
    CHECK(std::abs(dot(x, product(stiffness, y)) - dot(y, product(stiffness, x))) < 1e-6 * scale);

    std::vector<Vec3> branch;
    for (const Pair& pair : sample.pairs) branch.push_back(pair_vector(sample.box, sample.position, pair));
    std::vector<Pair> tied;
    for (std::size_t row = 0; row < sample.pairs.size(); row += 5) tied.push_back(sample.pairs[row]);
    const std::vector<RigidClusters> coarse{{sample.box, sample.position, tied}};
    const Eigen::Matrix3d allowed = Vec3(1.0, 0.0, 1.0).asDiagonal();
    Preconditioner<float> preconditioner(sample.box, network, sample.pairs, coarse);
    preconditioner.factorise(stiffness, branch);
    const auto inverse = [&](QuadMotion<float> r) {
        QuadMotion<float> z(r.displacement.size());
        project(r, allowed);
        for (std::size_t chunk = 0; chunk < network.chunks().size(); ++chunk) preconditioner.apply(chunk, r, z);
        preconditioner.apply_strain(r, z);
        project(z, allowed);
        preconditioner.add_coarse(allowed, r, z);
        return z;
    };
    const double size = std::sqrt(dot(x, inverse(x)) * dot(y, inverse(y)));
    CHECK(dot(x, inverse(x)) > 0.0);
    CHECK(std::abs(dot(x, inverse(y)) - dot(y, inverse(x))) < 1e-6 * size);
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
    fill(solver.stiffness(), network, sample);
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
