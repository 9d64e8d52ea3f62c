// conjugate_gradient.h: preconditioned conjugate gradients for block systems.
#pragma once

#include <functional>

#include "linalg/block_matrix.h"

namespace kiln::mechanics {

using linalg::BlockMatrix, linalg::Mat6, linalg::Vec6, linalg::Vector, linalg::worth_threads;

struct SolveReport {
    int iterations = 0;
    double residual = 0.0;  // norm of b - A x over that of b, recomputed at the end
    bool converged = false;
};

/// Improves x until the norm of b - A x is at most `tolerance` times that of b, or max_iterations are done.
/// A: symmetric positive semidefinite with b in its range; precondition(r, z): z = M^-1 r with M symmetric positive definite.
SolveReport conjugate_gradient(const BlockMatrix& matrix, const std::function<void(const Vector&, Vector&)>& precondition,
                               const Vector& b, Vector& x, double tolerance, int max_iterations);

}  // namespace kiln::mechanics
