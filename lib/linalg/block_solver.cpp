// block_solver.cpp: the passes of conjugate gradients over blocks, and the residual that judges them.
#include "linalg/block_solver.h"

#include "linalg/conjugate_gradient.h"

namespace kiln::linalg {

namespace {

constexpr int max_restarts = 3;  // with the residual as it is; each takes what rounding left of the one before

class BlockSystem {
   public:
    BlockSystem(const BlockMatrix& matrix, const std::function<void(const Vector&, Vector&)>& precondition, Vector& x, Vector& r,
                double goal)
        : matrix_(matrix), precondition_(precondition), x_(x), r_(r), goal_(goal), size_(norm(r)) {}

    double residual() const { return size_; }

    /// Without the product where the goal is reached: it would cost a pass of the preconditioner for nothing.
    double advance(double step) {
        if (step != 0.0) {
            add(step, p_, x_);
            add(-step, q_, r_);
            size_ = norm(r_);
        }
        if (size_ <= goal_) return 0.0;
        precondition_(r_, z_);
        return dot(r_, z_);
    }

    double turn(double ratio) {
        if (p_.empty())
            p_ = z_;
        else
            combine(z_, ratio, p_);
        multiply(matrix_, p_, q_);
        return dot(p_, q_);
    }

   private:
    const BlockMatrix& matrix_;
    const std::function<void(const Vector&, Vector&)>& precondition_;
    Vector &x_, &r_;
    Vector z_, p_, q_;
    double goal_, size_;
};

}  // namespace

SolveReport solve_blocks(const BlockMatrix& matrix, const std::function<void(const Vector&, Vector&)>& precondition,
                         const Vector& b, Vector& x, double tolerance, int max_iterations, const StopRequest& stop) {
    SolveReport report;
    x.resize(b.size(), Vec6::Zero());
    const double size = norm(b), goal = tolerance * size;
    Vector r;
    residual(matrix, x, b, r);
    for (int pass = 0; pass <= max_restarts && norm(r) > goal && report.iterations < max_iterations; ++pass) {
        BlockSystem system(matrix, precondition, x, r, goal);
        report.iterations += conjugate_gradient(system, [&](const CgProgress& progress) {
                                 throw_if_stopped(stop);
                                 return system.residual() <= goal || report.iterations + progress.iterations >= max_iterations;
                             }).iterations;
        residual(matrix, x, b, r);
    }
    report.residual = size > 0.0 ? norm(r) / size : 0.0;
    report.converged = norm(r) <= goal;
    return report;
}

}  // namespace kiln::linalg
