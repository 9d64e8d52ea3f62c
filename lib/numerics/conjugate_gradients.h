// conjugate_gradients.h: preconditioned conjugate gradients for the stiffness of a contact network with the box's strains.
#pragma once

#include "numerics/contact_network.h"
#include "numerics/preconditioner.h"

namespace kiln::numerics {

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

/// Solves K x = b from x = 0 until the goal is met.
///
/// A singular K (particles without contacts, clusters that hang on nothing) is allowed as long as b does no work on its null space.
/// allowed: projector onto the strains that the box may take. Work vectors are kept between calls.
class ConjugateGradients {
   public:
    explicit ConjugateGradients(std::size_t particles);

    LinearSolve solve(const ContactNetwork& network, const Preconditioner& preconditioner, const Eigen::Matrix3d& allowed,
                      const Motion& b, Motion& x, const LinearGoal& goal);

   private:
    Motion r_, z_, p_, q_;
    std::vector<double> total_;
};

/// Sum of the products of all components, particle by particle in chunks, strains last.
double dot(const ContactNetwork& network, const Motion& a, const Motion& b);

/// y += factor * x.
void add(const ContactNetwork& network, double factor, const Motion& x, Motion& y);

/// Takes away the part of the strains that is not allowed.
inline void project(Motion& motion, const Eigen::Matrix3d& allowed) { motion.strain = allowed * motion.strain; }

}  // namespace kiln::numerics
