// block_solver.h: preconditioned conjugate gradients for systems of 6x6 blocks.
#pragma once

#include <array>
#include <functional>

#include "core/stop.h"
#include "linalg/block_matrix.h"

namespace kiln::linalg {

struct SolveReport {
    int iterations = 0;
    double residual = 0.0;  // norm of b - A x over that of b, computed apart from the iteration
    bool converged = false;
};

template <int width>
using Preconditioner = std::function<void(const Batch<width>& r, Batch<width>& z)>;  // z = M^-1 r, of each field

/// Improves each field of x until the norm of b - A x is at most `tolerance` times that of b, or max_iterations are done. What the
/// iteration has lost by rounding is solved for again. An empty x is zero. Fields are independent of each other, but for the
/// reading of A and M.
/// A: symmetric positive semidefinite with b in its range; M symmetric positive definite, or nearly so. Width: 1 or 6.
/// Throws Error where a number is not finite, Interrupted where a stop is requested.
template <int width>
std::array<SolveReport, width> solve_blocks(const BlockMatrix& matrix, const Preconditioner<width>& precondition,
                                            const Batch<width>& b, Batch<width>& x, double tolerance, int max_iterations,
                                            const StopRequest& stop = {});

}  // namespace kiln::linalg
