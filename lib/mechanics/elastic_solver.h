// elastic_solver.h: linear response of a bond network: matrix, preconditioner and conjugate gradients, built once for many loads.
#pragma once

#include <array>
#include <memory>

#include "core/stop.h"
#include "mechanics/bond_network.h"
#include "mechanics/linear_solver.h"
#include "linalg/block_solver.h"
#include "linalg/multigrid.h"

namespace kiln::mechanics {

/// Freedoms of one node near the middle that springs hold to the ground, so that the matrix has no rigid motion left. The springs
/// are statically determinate: under loads in equilibrium they carry nothing, whatever their stiffness.
enum class Ground {
    displacement_and_rotation,  // of a free body
    displacement,               // of a periodic one
};

class ElasticSolver {
   public:
    /// stop: asked in each iteration of a solve, which throws Interrupted. other: solves in the place of conjugate gradients with
    /// the library's own multigrid.
    ElasticSolver(const BondNetwork& network, Ground ground, StopRequest stop = {}, const LinearSolverMaker& other = {});
    ElasticSolver(const ElasticSolver&) = delete;  // as large as the network
    ElasticSolver& operator=(const ElasticSolver&) = delete;

    /// Displacements under a load in equilibrium; x is where the search starts. See linalg::solve_springs for the result.
    linalg::SolveReport solve(const Vector& load, Vector& x, double tolerance, int max_iterations = 1000);

    /// The same of three loads at once: matrix and preconditioner are read once for them.
    std::array<linalg::SolveReport, 3> solve(const linalg::Batch<3>& load, linalg::Batch<3>& x, double tolerance,
                                             int max_iterations = 1000);

    /// Displacements under nearly a load, to a rough tolerance, and the forces that hold them. Gives the number of iterations.
    int respond(const Vector& load, Vector& displacement, Vector& force, double tolerance, int max_iterations = 1000);

    /// Forces that hold the network in a displacement field: the stiffness matrix without the ground, times the displacement.
    void forces(const Vector& displacement, Vector& force) const;

    /// Takes from the matrix what a bond of the network gave to it, but for this share. The preconditioner stays: it still is one
    /// for the softer body.
    void soften(const BondNetwork& network, std::size_t bond, double share);

    /// The bonds, without the ground.
    const linalg::Springs<double>& springs() const { return matrix_; }

    /// There is none where another solver is at work.
    linalg::Multigrid& preconditioner() { return *preconditioner_; }

   private:
    Residual residual() const;

    StopRequest stop_;
    linalg::Springs<double> matrix_;  // with the ground springs
    std::size_t grounded_ = 0;
    Vec6 ground_ = Vec6::Zero();
    std::unique_ptr<linalg::Multigrid> preconditioner_;
    std::unique_ptr<LinearSolver> other_;
};

}  // namespace kiln::mechanics
