// linear_solver_test.cpp: solvers of someone else behind ElasticSolver: what they leave is solved for again, what they say of it
// counts for nothing.
#include <doctest/doctest.h>

#include <Eigen/Cholesky>
#include <limits>

#include "mechanics/elastic_solver.h"
#include "mechanics/elastic_tensor.h"
#include "tests/physics/assembled.h"
#include "tests/physics/bonded_lattice.h"
#include "tests/physics/relative.h"

using namespace kiln;
using namespace kiln::linalg;
using namespace kiln::mechanics;
using test::relative;

namespace {

/// Finds this share of the solution, and claims a single iteration.
class Partial : public LinearSolver {
   public:
    Partial(const BondNetwork& network, const GroundSprings& ground, double share) : share_(share) {
        const BlockMatrix matrix = test::stiffness_matrix(network);
        matrix_ = Eigen::MatrixXd::Zero(6 * matrix.rows(), 6 * matrix.rows());
        for (std::int32_t row = 0; row < matrix.rows(); ++row)
            for (std::int64_t k = matrix.first(row); k < matrix.last(row); ++k)
                block(row, matrix.column[static_cast<std::size_t>(k)]) = matrix.block[static_cast<std::size_t>(k)];
        block(ground.node, ground.node).diagonal() += ground.stiffness;
    }

    int solve(const Vector& b, Vector& x, double, int) override {
        const auto size = static_cast<Eigen::Index>(6 * b.size());
        x.resize(b.size());
        Eigen::Map<Eigen::VectorXd> found(x.front().data(), size);
        found = share_ * matrix_.llt().solve(Eigen::Map<const Eigen::VectorXd>(b.front().data(), size));
        return 1;
    }

    void soften(const BondNetwork& network, std::size_t bond, double share) override {
        const auto [i, j] = network.pair[bond];
        const BondBlocks blocks = bond_blocks(network, bond);
        block(i, i) -= (1.0 - share) * blocks.ii;
        block(j, j) -= (1.0 - share) * blocks.jj;
        block(i, j) -= (1.0 - share) * blocks.ij;
        block(j, i) -= (1.0 - share) * blocks.ij.transpose();
    }

   private:
    template <typename Index>
    Eigen::Block<Eigen::MatrixXd, 6, 6> block(Index row, Index column) {
        return matrix_.block<6, 6>(6 * static_cast<Eigen::Index>(row), 6 * static_cast<Eigen::Index>(column));
    }

    double share_;
    Eigen::MatrixXd matrix_;
};

LinearSolverMaker partial(double share) {
    return [share](const BondNetwork& network, const GroundSprings& ground, const StopRequest&) {
        return std::make_unique<Partial>(network, ground, share);
    };
}

BondNetwork rough(bool periodic) {
    const State state = test::make_lattice(
        {.cells = {5, 4, 4}, .neighbour = 1.25, .periodic = periodic, .jitter = 0.2, .random_radii = true});
    return bonded_body(state, {}).network;
}

/// Opposite forces along x at both ends; moments that keep their balance.
Vector pull(const BondNetwork& network) {
    Vector load(network.nodes(), Vec6::Zero());
    const Vec3 force(1e-6, 0.0, 0.0), arm = network.position.back() - network.position.front();
    load.front() << -force, Vec3(arm[1] * force[2] - arm[2] * force[1], arm[2] * force[0] - arm[0] * force[2],
                                 arm[0] * force[1] - arm[1] * force[0]) / -network.rotation_length;
    load.back().head<3>() = force;
    return load;
}

}  // namespace

TEST_CASE("what another solver leaves is solved for again, up to five times") {
    const BondNetwork network = rough(false);
    const Vector load = pull(network);
    ElasticSolver own(network, Ground::displacement_and_rotation);
    ElasticSolver other(network, Ground::displacement_and_rotation, {}, partial(0.9));
    Vector expected, found;
    own.solve(load, expected, 1e-10);
    SolveReport report = other.solve(load, found, 1.5e-4);
    CHECK(report.iterations == 4);
    CHECK(report.converged);
    CHECK(report.residual == relative(1e-4, 1e-6));
    report = other.solve(load, found, 1.5e-9);  // from there
    CHECK(report.iterations == 5);
    CHECK(report.converged);
    add(-1.0, expected, found);
    CHECK(norm(found) < 1e-7 * norm(expected));
}

TEST_CASE("a solver that stops short of the tolerance, finds nothing or no number, is not believed") {
    const BondNetwork network = rough(false);
    const Vector load = pull(network);
    const auto solve = [&](double share) {
        ElasticSolver solver(network, Ground::displacement_and_rotation, {}, partial(share));
        Vector x;
        return solver.solve(load, x, 1e-8);
    };
    const SolveReport close = solve(0.9), far = solve(0.0);
    CHECK_FALSE(close.converged);
    CHECK(close.residual == relative(1e-5, 1e-6));
    CHECK_FALSE(far.converged);
    CHECK(far.residual == 1.0);
    CHECK_THROWS_WITH_AS(solve(std::numeric_limits<double>::quiet_NaN()), "a linear solve meets a number that is not finite",
                         Error);
}

TEST_CASE("six strains, and a softened bond, by another solver") {
    const BondNetwork periodic = rough(true);
    const ElasticTensor own = elastic_tensor(periodic, 1e-18, 1e-10);
    const ElasticTensor other = elastic_tensor(periodic, 1e-18, 1e-10, {}, partial(1.0));
    CHECK(other.converged);
    CHECK((other.stiffness - own.stiffness).norm() < 1e-8 * own.stiffness.norm());

    const BondNetwork network = rough(false);
    const Vector load = pull(network);
    Vector by_own, by_other;
    for (const bool others : {false, true}) {
        ElasticSolver solver(network, Ground::displacement_and_rotation, {}, others ? partial(1.0) : LinearSolverMaker());
        solver.soften(network, network.bonds() / 2, 0.01);
        CHECK(solver.solve(load, others ? by_other : by_own, 1e-10).converged);
    }
    add(-1.0, by_own, by_other);
    CHECK(norm(by_other) < 1e-7 * norm(by_own));
}
