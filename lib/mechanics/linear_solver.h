// linear_solver.h: what may solve the linear systems of a bond network in the place of the library's own multigrid.
#pragma once

#include <array>
#include <functional>
#include <memory>

#include "core/stop.h"
#include "linalg/block_solver.h"
#include "mechanics/bond_network.h"

namespace kiln::mechanics {

/// Springs that hold the freedoms of one node to the ground.
struct GroundSprings {
    std::size_t node = 0;
    Vec6 stiffness = Vec6::Zero();  // N/m
};

/// An iterative solver for the stiffness matrix of a network with its ground springs. What it says of its own success counts for
/// nothing: ElasticSolver measures the residual apart.
class LinearSolver {
   public:
    virtual ~LinearSolver() = default;

    /// x with A x = b as nearly as the tolerance, norm of what is left over that of b, asks for; gives the number of iterations.
    virtual int solve(const Vector& b, Vector& x, double tolerance, int max_iterations) = 0;

    /// See ElasticSolver::soften.
    virtual void soften(const BondNetwork& network, std::size_t bond, double share) = 0;
};

/// Makes one for a network, which is not needed afterwards. stop: asked in each iteration, which throws Interrupted.
using LinearSolverMaker =
    std::function<std::unique_ptr<LinearSolver>(const BondNetwork& network, const GroundSprings& ground, const StopRequest& stop)>;

/// r = b - A x.
using Residual = std::function<void(const Vector& x, const Vector& b, Vector& r)>;

/// Improves x until the norm of the residual is at most `tolerance` times that of the load, as linalg::solve_springs does: what the
/// solver leaves is solved for again. An empty x is zero. Throws Error where a number is not finite.
linalg::SolveReport solve_with(LinearSolver& solver, const Residual& residual, const Vector& load, Vector& x, double tolerance,
                               int max_iterations);

/// The same of three loads, one after the other.
std::array<linalg::SolveReport, 3> solve_with(LinearSolver& solver, const Residual& residual, const linalg::Batch<3>& load,
                                              linalg::Batch<3>& x, double tolerance, int max_iterations);

}  // namespace kiln::mechanics
