// tangent_solver.h: linear solves with the stiffness of a contact network and the strains of its box.
#pragma once

#include <functional>

#include "linalg/conjugate_gradient.h"
#include "sintering/coarse_spaces.h"

namespace kiln::sintering {

/// Sum of the products of all components, particle by particle in chunks, strains last.
double dot(const ContactNetwork& network, const Motion& a, const Motion& b);

/// y += factor * x.
void add(const ContactNetwork& network, double factor, const Motion& x, Motion& y);

/// Takes away the part of the strains that is not allowed.
template <typename AnyMotion>
void project(AnyMotion& motion, const Eigen::Matrix3d& allowed) { motion.strain = allowed * motion.strain; }

/// Keeps the stiffness, its preconditioner and work vectors, in the precision Real, between solves. Refers to the network and the
/// coarse spaces (see CoarseSpaces).
///
/// The preconditioner is M = (D + L) D^-1 (D + L^T) of the particles of each chunk (linalg::IncompleteCholesky), the inverse of the
/// strains' own block, and the coarse spaces. L is that of the stiffness itself, so one pass back and one forward through the
/// contacts of a chunk give the product and the preconditioner in one (Eisenstat, SIAM J. Sci. Stat. Comput. 2 (1981) 1; Saad,
/// Iterative methods for sparse linear systems, 2003, section 9.2.2): with w the residual r after (D + L) w = r, and the direction
/// p = (D + L^T)^-1 D y, the product after the same is v with D v = s, s = (A - D - L^T) p + D y - L (v - p).
template <typename Real>
class TangentSolver {
   public:
    TangentSolver(const Box& box, const ContactNetwork& network, std::span<const Pair> pairs,
                  std::span<const RigidClusters> coarse = {});
    TangentSolver(const TangentSolver&) = delete;
    TangentSolver& operator=(const TangentSolver&) = delete;

    linalg::EdgeStiffness<Real>& springs() { return stiffness_.springs(); }

    /// Takes the present springs into the stiffness and the preconditioner. branch: from node to node of each pair, m.
    void factorise(std::span<const Vec3> branch);

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
    /// Of p with q = A p, and of the preconditioned q with the residual and with q itself; q of the strains.
    struct Product {
        double curvature = 0.0, residual = 0.0, square = 0.0;
        Vec3 strain = Vec3::Zero();
        void operator+=(const Product& other) {
            curvature += other.curvature;
            residual += other.residual;
            square += other.square;
            strain += other.strain;
        }
    };
    double start(std::size_t chunk, const Motion& b, double scale);
    double take_step(std::size_t chunk, Real step);
    double apply_coarse();
    double find_direction(std::size_t chunk, Real step, Real ratio);
    Product multiply(std::size_t chunk);

    const ContactNetwork& network_;
    Stiffness<Real> stiffness_;
    CoarseSpaces<Real> coarse_;
    Eigen::Matrix3d allowed_ = Eigen::Matrix3d::Identity();
    // Of each particle: x, p and y; D w of the residual; s of the product; and (A_jj p_j + L^T p), what each contact brings to the
    // product whose force is known before the forward pass. Strains beside them, without any transformation.
    std::vector<Quad<Real>> x_, p_, y_, residual_, product_, known_;
    Vec3 x_strain_, p_strain_, residual_strain_, z_strain_, product_strain_;
    double step_ = 0.0;      // that x and the residual have yet to make along p: turn() does both in its first pass
    double residual2_ = 0.0;  // of the residual with the preconditioned residual, before that step
    Product product_of_;      // of the present p
    QuadMotion<Real> coarse_r_, coarse_z_;  // where there are coarse spaces
};

}  // namespace kiln::sintering
