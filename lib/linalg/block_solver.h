// block_solver.h: preconditioned conjugate gradients for systems of 6x6 blocks.
#pragma once

#include <functional>

#include "core/stop.h"
#include "linalg/block_matrix.h"

namespace kiln::linalg {

struct SolveReport {
    int iterations = 0;
    double residual = 0.0;  // norm of b - A x over that of b, computed apart from the iteration
    bool converged = false;
};

/// Improves x until the norm of b - A x is at most `tolerance` times that of b, or max_iterations are done. What the iteration has
/// lost by rounding is solved for again.
/// A: symmetric positive semidefinite with b in its range; precondition(r, z): z = M^-1 r with M symmetric positive definite.
/// Throws Error where a number is not finite, Interrupted where a stop is requested.
SolveReport solve_blocks(const BlockMatrix& matrix, const std::function<void(const Vector&, Vector&)>& precondition,
                         const Vector& b, Vector& x, double tolerance, int max_iterations, const StopRequest& stop = {});

}  // namespace kiln::linalg
