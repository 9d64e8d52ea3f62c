// elastic_solver.cpp: grounding, preconditioning and solving of a bond network.
#include "mechanics/elastic_solver.h"

#include <algorithm>
#include <utility>

namespace kiln::mechanics {

namespace {

/// Two nodes a bond: a sum of such matrices is at most twice its block diagonal.
constexpr double max_eigenvalue_of_bonds = 2.0;

std::size_t middle_node(const BondNetwork& network) {
    Vec3 centre = Vec3::Zero();
    for (const Vec3& position : network.position) centre += position;
    centre /= static_cast<double>(network.nodes());
    std::size_t nearest = 0;
    for (std::size_t node = 1; node < network.nodes(); ++node) {
        if ((network.position[node] - centre).squaredNorm() < (network.position[nearest] - centre).squaredNorm()) nearest = node;
    }
    return nearest;
}

linalg::NodeGeometry geometry_of(const BondNetwork& network) {
    linalg::NodeGeometry geometry{network.position, network.period / network.rotation_length};
    for (Vec3& position : geometry.position) position /= network.rotation_length;
    return geometry;
}

}  // namespace

ElasticSolver::ElasticSolver(const BondNetwork& network, Ground ground, StopRequest stop, const LinearSolverMaker& other)
    : stop_(std::move(stop)), matrix_(stiffness_matrix(network)), grounded_(middle_node(network)) {
    const auto row = static_cast<std::int32_t>(grounded_);
    for (std::int64_t k = matrix_.first(row); k < matrix_.last(row); ++k) {
        if (matrix_.column[static_cast<std::size_t>(k)] != row) continue;
        Mat6& block = matrix_.block[static_cast<std::size_t>(k)];
        const double mean = block.trace() / 6.0;
        ground_.head<3>().setConstant(mean);
        if (ground == Ground::displacement_and_rotation) ground_.tail<3>().setConstant(mean);
        block.diagonal() += ground_;
    }
    if (other)
        other_ = other(network, {grounded_, ground_}, stop_);
    else
        preconditioner_ = std::make_unique<linalg::Multigrid>(matrix_, geometry_of(network), max_eigenvalue_of_bonds);
}

Residual ElasticSolver::residual() const {
    return [this](const Vector& x, const Vector& b, Vector& r) { linalg::residual<1>(matrix_, x, b, r); };
}

linalg::SolveReport ElasticSolver::solve(const Vector& load, Vector& x, double tolerance, int max_iterations) {
    if (other_) return solve_with(*other_, residual(), load, x, tolerance, max_iterations);
    const auto precondition = [this](const Vector& r, Vector& z) {
        throw_if_stopped(stop_);
        preconditioner_->apply<1>(r, z);
    };
    return linalg::solve_blocks<1>(matrix_, precondition, load, x, tolerance, max_iterations)[0];
}

std::array<linalg::SolveReport, 6> ElasticSolver::solve(const linalg::Batch<6>& load, linalg::Batch<6>& x, double tolerance,
                                                        int max_iterations) {
    if (other_) return solve_with(*other_, residual(), load, x, tolerance, max_iterations);
    const auto precondition = [this](const linalg::Batch<6>& r, linalg::Batch<6>& z) {
        throw_if_stopped(stop_);
        preconditioner_->apply<6>(r, z);
    };
    return linalg::solve_blocks<6>(matrix_, precondition, load, x, tolerance, max_iterations);
}

void ElasticSolver::soften(const BondNetwork& network, std::size_t bond, double share) {
    if (other_) other_->soften(network, bond, share);
    const auto [i, j] = network.pair[bond];
    const BondBlocks blocks = bond_blocks(network, bond);
    const auto block_at = [&](std::int32_t row, std::int32_t column) -> Mat6& {
        const auto begin = matrix_.column.begin() + matrix_.first(row), end = matrix_.column.begin() + matrix_.last(row);
        return matrix_.block[static_cast<std::size_t>(std::lower_bound(begin, end, column) - matrix_.column.begin())];
    };
    const double lost = 1.0 - share;
    block_at(i, i) -= lost * blocks.ii;
    block_at(j, j) -= lost * blocks.jj;
    block_at(i, j) -= lost * blocks.ij;
    block_at(j, i) -= lost * blocks.ij.transpose();
}

void ElasticSolver::forces(const Vector& displacement, Vector& force) const {
    linalg::multiply<1>(matrix_, displacement, force);
    force[grounded_] -= ground_.cwiseProduct(displacement[grounded_]);
}

}  // namespace kiln::mechanics
