// conjugate_gradient.h: preconditioned conjugate gradients, and their estimate of the error. Batches: block_solver.h.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "core/types.h"

namespace kiln::linalg {

/// How far a solve has come. The energy norm of a field is the square root of x . K x.
struct CgProgress {
    int iterations = 0;
    double energy = 0.0;    // square of the energy norm of the solution so far
    double error2 = 0.0;    // estimated square of the energy norm of what is missing
    double residual2 = 0.0; // r . M^-1 r

    /// Estimated error over the solution, in the energy norm.
    double relative_error() const { return energy > 0.0 ? std::sqrt(error2 / energy) : 0.0; }
};

/// Estimate of the error of conjugate gradients in the energy norm.
///
/// Iteration k adds step_k * r_k . z_k to the square of the energy norm of the solution, and takes as much off that of the error:
/// Hestenes & Stiefel 1952, theorem 6:1; that the identity holds in finite precision: Strakos & Tichy, ETNA 13 (2002) 56. The error
/// that is left is the sum of the terms to come; here they go on as a geometric series with the mean ratio of the last few.
class EnergyError {
   public:
    /// term: step_k * r_k . z_k; next: the term to come, step_k * r_(k+1) . z_(k+1) by the last step's length.
    double after(double term, double next) {
        terms_[static_cast<std::size_t>(count_++) % terms_.size()] = term;
        const int window = std::min(count_, static_cast<int>(terms_.size()));
        const double oldest = terms_[static_cast<std::size_t>(count_ - window) % terms_.size()];
        if (!(next > 0.0)) return 0.0;
        const double ratio = std::pow(next / oldest, 1.0 / window);
        return next / (1.0 - std::min(ratio, max_ratio));
    }

   private:
    static constexpr double max_ratio = 0.99;  // terms that do not fall are taken to fall slowly
    std::array<double, 4> terms_{};
    int count_ = 0;
};

/// Solves K x = b from where the system stands. A System keeps x, the residual r = b - K x, the direction p and q = K p, and does
///   double advance(double step)   x += step p, r -= step q, z = M^-1 r; gives r . z
///   double turn(double ratio)     p = z + ratio p, q = K p; gives p . q
/// done(const CgProgress&) is asked before the first iteration and after each one; it may throw to end a solve from outside.
///
/// K is symmetric positive semidefinite with b in its range, M symmetric positive definite on it. Throws Error where a number is
/// not finite. Saad, Iterative methods for sparse linear systems, 2003, algorithm 9.1.
template <typename System, typename Done>
CgProgress conjugate_gradient(System& system, const Done& done) {
    CgProgress progress;
    EnergyError error;
    double product = system.advance(0.0), ratio = 0.0;
    progress.residual2 = progress.error2 = product;
    while (!done(progress)) {
        const double curvature = system.turn(ratio);
        if (!std::isfinite(product) || !std::isfinite(curvature)) throw Error("a linear solve meets a number that is not finite");
        if (!(curvature > 0.0)) break;  // only motion that costs nothing is left
        const double step = product / curvature, next = system.advance(step);
        progress.energy += step * product;
        progress.error2 = error.after(step * product, step * next);
        progress.residual2 = next;
        ratio = next / product;
        product = next;
        ++progress.iterations;
    }
    return progress;
}

}  // namespace kiln::linalg
