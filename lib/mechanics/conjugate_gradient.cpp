// conjugate_gradient.cpp: preconditioned conjugate gradients (Saad 2003, algorithm 9.1).
#include "mechanics/conjugate_gradient.h"

namespace kiln::mechanics {

using linalg::add, linalg::dot, linalg::multiply, linalg::norm, linalg::residual;

SolveReport conjugate_gradient(const BlockMatrix& matrix, const std::function<void(const Vector&, Vector&)>& precondition,
                               const Vector& b, Vector& x, double tolerance, int max_iterations) {
    SolveReport report;
    x.resize(b.size(), Vec6::Zero());
    const double wanted = tolerance * norm(b);
    Vector r, z, p, q;
    residual(matrix, x, b, r);
    double rz = 0.0;
    for (; report.iterations < max_iterations && norm(r) > wanted; ++report.iterations) {
        precondition(r, z);
        const double old_rz = rz;
        rz = dot(r, z);
        if (report.iterations == 0) {
            p = z;
        } else {
            const double beta = rz / old_rz;
#pragma omp parallel for schedule(static) if (p.size() > worth_threads)
            for (std::size_t i = 0; i < p.size(); ++i) p[i] = z[i] + beta * p[i];
        }
        multiply(matrix, p, q);
        const double curvature = dot(p, q);
        if (!(curvature > 0.0)) break;
        const double alpha = rz / curvature;
        add(alpha, p, x);
        add(-alpha, q, r);
    }
    residual(matrix, x, b, r);
    const double size = norm(b);
    report.residual = size > 0.0 ? norm(r) / size : 0.0;
    // The recursion drifts from the true residual by rounding; a factor of two is allowed for.
    report.converged = report.residual <= 2.0 * tolerance;
    return report;
}

}  // namespace kiln::mechanics
