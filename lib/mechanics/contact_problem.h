// contact_problem.h: equilibrium of a bonded body between rigid supports below and a rigid punch above.
#pragma once

#include <vector>

#include "mechanics/contact_minimum.h"
#include "mechanics/contact_set.h"
#include "mechanics/reduced_space.h"

namespace kiln::mechanics {

struct Equilibrium {
    Vector displacement;              // of every node
    double punch = 0.0;               // m, travel of the punch downwards
    double punch_force = 0.0;         // N, downwards
    double punch_compliance = 0.0;    // m/N, d punch / d force, friction's limits as they are
    std::vector<Vec3> contact_force;  // N, on the particle, one per wall contact
    std::size_t closed_gaps = 0;      // pairs without a bond that press each other
    double bond_energy = 0.0;         // J
    double contact_energy = 0.0;      // J
    double friction_loss = 0.0;       // J, since the beginning
    int iterations = 0;               // of the linear solver, since the last equilibrium
    double residual = 0.0;            // norm of the unbalanced forces over that of the contacts' normal forces
    bool converged = false;
};

/// A rigid body under a punch.
struct Seat {
    Vector displacement;  // of every node, m and rad times the rotation length
    double punch = 0.0;   // m, travel of the punch
};

/// The body as rigid, under next to nothing of a punch force (N), on rollers: lifted, rolled and pitched by small angles.
Seat seat_rigid(const BondNetwork& network, const std::vector<WallContact>& walls, double force);

/// Finds equilibria under rising or falling punch forces. Total energy (bonds, Hertz contacts, punch) is convex. It is minimised
/// over a growing space of displacement fields: first the body's rigid motions in the field of the contacts, then, one by one, the
/// elastic response to the forces that the last minimum left unbalanced. The bonds' matrix is preconditioned once; a minimum in the
/// space is a small dense problem; the space serves all forces. Contacts between particles enter where their gap has closed.
/// With friction each minimum is found for given limits of the tangential forces, which are then taken anew from the normal forces
/// until they no longer change: all matrices stay symmetric.
class ContactProblem {
   public:
    /// pairs: all that may come to touch. friction: coefficient of all contacts. seating_force, N: the body lies under it as a
    /// rigid one, without sliding along x or y; there contact begins as the force goes to zero. finest_tolerance: of all
    /// equilibria that will be asked for. Network and solver must outlive the problem.
    ContactProblem(const BondNetwork& network, ElasticSolver& solver, const std::vector<WallContact>& walls,
                   std::vector<PairContact> pairs, double friction, double seating_force, double finest_tolerance);

    /// m, travel of the punch to the body at its seat.
    double seat() const { return seated_[0]; }

    /// Equilibrium under a punch force > 0, N, until `residual` is at most `tolerance` or the space is full.
    Equilibrium solve(double force, double tolerance) { return search({force}, tolerance); }

    /// Equilibrium with the punch held where it is, such as after a bond broke; force: the last one, N, as a measure.
    Equilibrium relax(double force, double tolerance) { return search({force, true}, tolerance); }

    /// The last equilibrium counts as gone through: friction of those to come starts from there.
    void keep() { contacts_.keep(freedoms_); }

    /// The punch and with it all force is gone; loading begins anew.
    void release();

    double friction_loss() const { return contacts_.lost(freedoms_); }  // J, since the beginning

    /// Leaves this share of a bond's stiffness, which the network still has whole, to the body; its ends may press each other from
    /// now on. The network is left to the caller.
    void soften(std::size_t bond, double share, const PairContact& ends);

   private:
    Equilibrium search(const PunchLoad& load, double tolerance);
    bool settle(const PunchLoad& load, double tolerance);
    Vector unbalanced(const ContactSet::Forces& forces) const;
    bool add_response(const Vector& unbalanced, int& iterations);
    void join_old_fields(std::size_t most, std::size_t left);
    void conclude(Equilibrium& state, const ContactSet::Forces& forces, const PunchLoad& load) const;

    const BondNetwork& network_;
    ElasticSolver& solver_;
    bool exact_;             // forces of fields are those of the numbers kept, not those of the linear solver
    bool softened_ = false;  // some bond is, which the preconditioner does not know
    ReducedSpace space_;
    ContactSet contacts_;
    Eigen::VectorXd freedoms_;  // m, of the space
    Eigen::VectorXd seated_;    // the same at the seat; only the first ones
};

}  // namespace kiln::mechanics
