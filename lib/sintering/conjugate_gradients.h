// conjugate_gradients.h: preconditioned conjugate gradients for the stiffness of a contact network with the box's strains.
#pragma once

#include "sintering/preconditioner.h"

namespace kiln::sintering {

struct LinearSolve {
    int iterations = 0;
    double residual = 0.0;  // norm of the preconditioned residual over that of the right-hand side
    double start = 0.0;     // square of that norm of the right-hand side
};

/// When a linear solve ends: its error, by the preconditioned residual, is to be `tightest` times that at the start, or, if that is
/// more, the start's own error relative to the scale but no more than `loosest`.
struct LinearGoal {
    double loosest = 1e-8, tightest = 1e-8;
    double scale = 0.0;         // square of the solution's norm in the energy; 0: the first rule alone
    double enough = 0.0;        // square of an error that is good enough anyhow
    int most_iterations = 5000;
};

/// Solves K x = b from x = 0 until the goal is met. The iteration is in single precision: goals below 1e-5 or so are for the caller
/// to reach, by solving again for what is left of b.
///
/// A singular K (particles without contacts, clusters that hang on nothing) is allowed as long as b does no work on its null space.
/// allowed: projector onto the strains that the box may take. Work vectors are kept between calls.
class ConjugateGradients {
   public:
    explicit ConjugateGradients(std::size_t particles);

    LinearSolve solve(const Stiffness& stiffness, const Preconditioner& preconditioner, const Eigen::Matrix3d& allowed,
                      const Motion& b, Motion& x, const LinearGoal& goal);

   private:
    /// Takes step * p off what is left, and gives the product of what is left, r, and its preconditioned z.
    double advance(const Stiffness& stiffness, const Preconditioner& preconditioner, const Eigen::Matrix3d& allowed, double step);
    /// The next direction p = z + ratio * p, and q = K p; gives their product.
    double turn(const Stiffness& stiffness, const Eigen::Matrix3d& allowed, double ratio);

    QuadMotion x_, r_, z_, p_, q_;
    std::vector<Quad> total_;
    std::vector<Vec3> work_;
};

/// Sum of the products of all components, particle by particle in chunks, strains last.
double dot(const ContactNetwork& network, const Motion& a, const Motion& b);

/// y += factor * x.
void add(const ContactNetwork& network, double factor, const Motion& x, Motion& y);

/// Takes away the part of the strains that is not allowed.
template <typename AnyMotion>
void project(AnyMotion& motion, const Eigen::Matrix3d& allowed) { motion.strain = allowed * motion.strain; }

}  // namespace kiln::sintering
