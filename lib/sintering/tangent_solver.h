// tangent_solver.h: linear solves with the stiffness of a contact network and the strains of its box.
#pragma once

#include <functional>

#include "linalg/conjugate_gradient.h"
#include "sintering/preconditioner.h"

namespace kiln::sintering {

/// Sum of the products of all components, particle by particle in chunks, strains last.
double dot(const ContactNetwork& network, const Motion& a, const Motion& b);

/// y += factor * x.
void add(const ContactNetwork& network, double factor, const Motion& x, Motion& y);

/// Takes away the part of the strains that is not allowed.
template <typename AnyMotion>
void project(AnyMotion& motion, const Eigen::Matrix3d& allowed) { motion.strain = allowed * motion.strain; }

/// Keeps the stiffness, its preconditioner and work vectors, in the precision Real, between solves. Refers to the network and the
/// coarse spaces (see Preconditioner).
template <typename Real>
class TangentSolver {
   public:
    TangentSolver(const Box& box, const ContactNetwork& network, std::span<const Pair> pairs,
                  std::span<const RigidClusters> coarse = {});
    TangentSolver(const TangentSolver&) = delete;
    TangentSolver& operator=(const TangentSolver&) = delete;

    Stiffness<Real>& stiffness() { return stiffness_; }
    const Stiffness<Real>& stiffness() const { return stiffness_; }

    /// Takes the present stiffness into the preconditioner. branch: from node to node of each pair, m.
    void factorise(std::span<const Vec3> branch) { preconditioner_.factorise(stiffness_, branch); }

    /// Solves K x = b from x = 0 until done(progress) says so. Vectors are scaled to numbers near one on the way. In single
    /// precision goals below 1e-5 or so are for the caller to reach, by solving again for what is left of b.
    ///
    /// A singular K (particles without contacts, clusters that nothing holds) is allowed as long as b does no work on its null
    /// space. allowed: projector onto the strains that the box may take. Throws Error where a number is not finite.
    linalg::CgProgress solve(const Eigen::Matrix3d& allowed, const Motion& b, Motion& x,
                             const std::function<bool(const linalg::CgProgress&)>& done);

    /// The two passes of linalg::conjugate_gradient.
    double advance(double step);
    double turn(double ratio);

   private:
    const ContactNetwork& network_;
    Stiffness<Real> stiffness_;
    Preconditioner<Real> preconditioner_;
    Eigen::Matrix3d allowed_ = Eigen::Matrix3d::Identity();
    QuadMotion<Real> x_, r_, z_, p_, q_;
    std::vector<Quad<Real>> total_;
    std::vector<Vec3> work_;
};

}  // namespace kiln::sintering
