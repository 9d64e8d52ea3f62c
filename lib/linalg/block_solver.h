// block_solver.h: preconditioned conjugate gradients for nodes that springs connect.
#pragma once

#include <array>

#include "core/stop.h"
#include "linalg/multigrid.h"
#include "linalg/springs.h"

namespace kiln::linalg {

struct SolveReport {
    int iterations = 0;
    double residual = 0.0;  // norm of b - A x over that of b, computed apart from the iteration
    bool converged = false;
};

/// Improves the fields of x until the norm of b - A x of each is at most `tolerance` times that of b, or max_iterations are done.
/// What the iteration has lost by rounding is solved for again. An empty x is zero. Fields are independent of each other, but for
/// the reading of A and M.
/// A: symmetric positive semidefinite with b in its range. Widths: 1 and 3.
/// Throws Error where a number is not finite, Interrupted where a stop is requested.
template <int width>
std::array<SolveReport, width> solve_springs(const Springs<double>& matrix, Multigrid& preconditioner, const Batch<width>& b,
                                             Batch<width>& x, double tolerance, int max_iterations, const StopRequest& stop = {});

/// x with A x = b - r, where r is at most `tolerance` times b as the iteration has it: nothing is computed apart. Gives the number
/// of iterations.
int solve_roughly(const Springs<double>& matrix, Multigrid& preconditioner, const Vector& b, Vector& x, Vector& r, double tolerance,
                  int max_iterations, const StopRequest& stop = {});

}  // namespace kiln::linalg
