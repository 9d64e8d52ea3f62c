// elastic_solver.cpp: grounding, preconditioning and solving of a bond network.
#include "mechanics/elastic_solver.h"

#include <utility>

namespace kiln::mechanics {

namespace {

/// Two nodes a bond: a sum of such matrices is at most twice its block diagonal.
constexpr double max_eigenvalue_of_bonds = 2.0;

std::size_t at(std::int32_t index) { return static_cast<std::size_t>(index); }

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
    : stop_(std::move(stop)), matrix_(network.nodes(), springs_of(network)), grounded_(middle_node(network)) {
    Mat6 block = Mat6::Zero();
    for (std::size_t bond = 0; bond < network.bonds(); ++bond) {
        const auto [i, j] = network.pair[bond];
        if (at(i) == grounded_) block += bond_blocks(network, bond).ii;
        if (at(j) == grounded_) block += bond_blocks(network, bond).jj;
    }
    const double mean = block.trace() / 6.0;
    ground_.head<3>().setConstant(mean);
    if (ground == Ground::displacement_and_rotation) ground_.tail<3>().setConstant(mean);
    matrix_.hold(grounded_, ground_);
    if (other)
        other_ = other(network, {grounded_, ground_}, stop_);
    else
        preconditioner_ = std::make_unique<linalg::Multigrid>(matrix_, geometry_of(network), max_eigenvalue_of_bonds);
}

Residual ElasticSolver::residual() const {
    return [this](const Vector& x, const Vector& b, Vector& r) {
        linalg::residual<1>(matrix_, x, b, r);
    };
}

linalg::SolveReport ElasticSolver::solve(const Vector& load, Vector& x, double tolerance, int max_iterations) {
    if (other_) return solve_with(*other_, residual(), load, x, tolerance, max_iterations);
    return linalg::solve_springs<1>(matrix_, *preconditioner_, load, x, tolerance, max_iterations, stop_)[0];
}

std::array<linalg::SolveReport, 3> ElasticSolver::solve(const linalg::Batch<3>& load, linalg::Batch<3>& x, double tolerance,
                                                        int max_iterations) {
    if (other_) return solve_with(*other_, residual(), load, x, tolerance, max_iterations);
    return linalg::solve_springs<3>(matrix_, *preconditioner_, load, x, tolerance, max_iterations, stop_);
}

int ElasticSolver::respond(const Vector& load, Vector& displacement, Vector& force, double tolerance, int max_iterations) {
    if (other_) {
        const int iterations = solve(load, displacement, tolerance, max_iterations).iterations;
        forces(displacement, force);
        return iterations;
    }
    const int iterations =
        linalg::solve_roughly(matrix_, *preconditioner_, load, displacement, force, tolerance, max_iterations, stop_);
    for_rows(force.size(), [&](std::size_t node) { force[node] = load[node] - force[node]; }, worth_threads);  // what is not left
    force[grounded_] -= ground_.cwiseProduct(displacement[grounded_]);
    return iterations;
}

void ElasticSolver::soften(const BondNetwork& network, std::size_t bond, double share) {
    if (other_) other_->soften(network, bond, share);
    matrix_.soften(bond, share);
}

void ElasticSolver::forces(const Vector& displacement, Vector& force) const {
    linalg::multiply(matrix_, displacement, force);
    force[grounded_] -= ground_.cwiseProduct(displacement[grounded_]);
}

}  // namespace kiln::mechanics
