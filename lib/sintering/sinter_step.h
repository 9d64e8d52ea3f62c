// sinter_step.h: one implicit step of overdamped sintering, the minimum of a convex function of the step's motion.
//
// Balance of all contact forces at the end of the step makes the sum over contacts
//     D(w) + kt/2 |u_t|^2 - f w,   D'(w) = K/(3 I) [(h + w)+^3 - h+^3]
// stationary, where w is the approach along the contact normal, u_t the tangential motion, h the overlap at the start, K h^2/Delta
// the normal viscosity, I the integral of Delta over the step, kt the tangential viscosity over I and f the sintering force. The
// cube is the exact integral of the viscosity over the overlap: an isolated pair is exact for a step of any length.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "core/stop.h"
#include "sintering/unilateral_constraints.h"
#include "sintering/contact_network.h"
#include "sintering/tangent_solver.h"

namespace kiln::sintering {

/// What one pair brings into a step. Geometry is that at the start of the step. A pair that does not diffuse has neither force nor
/// viscosity; it can only reach its limit. Forces may be in any unit, the same for all: only their ratios move anything.
struct PairStep {
    Vec3 vector;             // l, from i to j, m
    Vec3 branch;              // from node to node of the network, m; l for particles that move by themselves
    double distance;         // |l|, m
    double overlap;          // h, m; negative for a gap
    double reduced_radius;   // R*, m
    double force;            // f
    double cubic;            // K/I, force/m3
    double shear;            // tangential viscosity over h and I, force/m2
    double limit;            // largest approach, m; infinity for none
    double spring;           // stiffness of the spring at the limit, force/m; zero where the limit is met to rounding
    double slowness;         // integral of Delta over the step of the fastest pair over that of this one; zero where none diffuses
};

struct StepSettings {
    Eigen::Matrix3d allowed_strain = Eigen::Matrix3d::Identity();  // projector onto the strains that the box may take
    std::optional<Vec3> held_strain{};                // along the other axes, if not zero
    Vec3 pressure = Vec3::Zero();                     // force/m2, compressive, along the free axes
    double first_tolerance = 1e-3, second_tolerance = 1e-3;  // relative errors of the motions of both orders in the energy norm
    bool balance_first = true;  // judge the motion of first order particle by particle; not needed where it only predicts
    int limit_corrections = 0;  // passes that take off by how much springs at limits yield, unless they soon yield nothing
    StopRequest stop;                                 // asked between iterations; the step then throws Interrupted
};

struct StepReport {
    int newton = 0;
    int conjugate_gradients = 0;
    bool converged = true;
    double imbalance = 0.0;  // largest force left on a particle, a cluster or the box, over the forces that contacts exert on it
    Vec3 stress = Vec3::Zero();  // mean over the step along the axes, tension positive, force/m2
};

/// Solves one step. Keeps references to the pairs and to what each of them brings into it (a row a pair).
///
/// A motion is converged when its error in the energy norm, estimated by a linear solve for what is left of the forces, is below
/// the tolerance, and the forces on each particle, on each cluster of particles that slow contacts tie together, and on the box are
/// in balance. Throws Error where a number is not finite.
class SinterStep {
   public:
    SinterStep(const Box& box, std::span<const Vec3> position, std::span<const Pair> pairs, std::span<const PairStep> step,
               const StepSettings& settings);
    SinterStep(const SinterStep&) = delete;  // the solver refers to the network
    SinterStep& operator=(const SinterStep&) = delete;

    /// Motion over the step with the geometry at its start, from a guess of it: first order in the length of the step.
    StepReport first_order(Motion& motion);

    /// Motion with the geometry half way through `first`, the motion of first order, from a guess of it: second order.
    StepReport second_order(const Motion& first, Motion& motion);

   private:
    /// What the force of one pair depends on besides the motion, for one geometry.
    struct PairForce {
        Vec3 normal;                                 // unit vector, from i to j
        double overlap, cubic, isolated_end, driving, tangential;  // h; K/I; h at the end if alone; fraction of f; kt
    };
    /// Relative motion of pair `row` under a motion, m.
    Vec3 relative(std::size_t row, const Motion& motion) const;
    const PairForce& force_of(std::size_t row) const { return entries_[network_.entry_of(row)]; }
    /// The approach of pair `row` under a motion, m.
    double approach(std::size_t row, const Motion& motion) const { return -force_of(row).normal.dot(relative(row, motion)); }
    /// Overlap at the end of the step of a pair that nothing else holds and that touches for a fraction of it, m.
    double isolated_end(std::size_t row, double fraction) const;
    /// Of a pair with this normal that touches for a fraction of the step; isolated_end, end_overlap: overlap at the end, alone
    /// and expected.
    PairForce pair_force(std::size_t row, const Vec3& normal, double fraction, double isolated_end, double end_overlap) const;
    void start_geometry();
    void midpoint_geometry(const Motion& motion);
    template <typename ForceOf>
    void take_geometry(const Motion& motion, const ForceOf& force_of);
    void start_limits();
    /// balance: also the forces on each particle are to be in balance.
    bool minimise(double tolerance, bool balance, Motion& motion, StepReport& report);
    bool newton(double tolerance, bool balance, Motion& motion, StepReport& report);
    double line_search(double slope, Motion& motion);
    /// The forces that a motion leaves unbalanced, and the stiffness there.
    void forces(const Motion& motion, bool secant);
    template <bool limited, typename Real>
    void forces(TangentSolver<Real>& solver, const Motion& motion, bool secant);
    /// Size of the force of each pair, and what they do to the box if all add up.
    struct Exerted {
        std::vector<double> by_pair;
        Vec3 on_box = Vec3::Zero();
    };
    Exerted exerted() const;
    /// Largest unbalanced force of the last call of forces(), see StepReport.
    double imbalance() const;
    std::vector<std::size_t> few_unbalanced(double limit) const;
    void relax(const std::vector<std::size_t>& particles);
    void remove_drift(Motion& motion) const;

    Box box_;
    std::span<const Pair> pairs_;
    std::span<const PairStep> step_;
    StepSettings settings_;
    ContactNetwork network_;
    double slowest_ = 0.0;  // of any pair, see PairStep
    std::vector<RigidClusters> coarse_;  // of particles that slow contacts tie together
    std::variant<std::unique_ptr<TangentSolver<float>>, std::unique_ptr<TangentSolver<double>>> solver_;
    bool limited_ = false;  // any pair
    UnilateralConstraints limits_;
    std::unique_ptr<PairForce[]> entries_;  // in the order of the network
    std::unique_ptr<double[]> alone_;       // overlap of each pair at the end of the step if it touches throughout, m
    std::unique_ptr<double[]> resisting_;   // by how much each entry and its limit resisted in the last call of forces()
    std::vector<Vec3> branch_;              // a row a pair, m
    std::vector<linalg::WideQuad> total_;
    Motion driving_forces_, unbalanced_, direction_;  // driving_forces_: the driving forces alone
    Vec3 pressure_volume_ = Vec3::Zero();  // work of the pressure for a unit strain along each axis
    Vec3 strain_force_ = Vec3::Zero();     // work of the contacts for the same, in the last call of forces()
    double work_ = 0.0;                    // of the driving forces in the last call of forces()
};

}  // namespace kiln::sintering
