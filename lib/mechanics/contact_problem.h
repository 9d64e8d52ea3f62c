// contact_problem.h: equilibrium of a bonded body between rigid supports below and a rigid punch above.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mechanics/elastic_solver.h"
#include "mechanics/particle_contacts.h"
#include "mechanics/wall_contact.h"

namespace kiln::mechanics {

struct Equilibrium {
    Vector displacement;                // of every node
    double punch = 0.0;                 // m, travel of the punch downwards
    double punch_compliance = 0.0;      // m/N, d punch / d force
    std::vector<double> contact_force;  // N, along z, one per wall contact, never negative
    std::size_t closed_gaps = 0;        // pairs without a bond that press each other
    double bond_energy = 0.0;           // J
    double contact_energy = 0.0;        // J
    int iterations = 0;                 // of the linear solver, since the last equilibrium
    double residual = 0.0;              // norm of the unbalanced forces over that of the contact forces
    bool converged = false;
};

/// Finds equilibria under rising or falling punch forces. Total energy (bonds, Hertz contacts, punch) is convex. It is minimised
/// over a growing space of displacement fields: first the body's rigid motions in the field of the contacts, then, one by one, the
/// elastic response to the forces that the last minimum left unbalanced. The bonds' matrix is preconditioned once; a minimum in the
/// space is a small dense problem; the space serves all forces. Contacts between particles enter where their gap has closed.
class ContactProblem {
   public:
    /// solver: null for a body that is only seated. pairs: all that may come to touch. The network must outlive the problem.
    ContactProblem(const BondNetwork& network, ElasticSolver* solver, const std::vector<WallContact>& walls,
                   std::vector<PairContact> pairs = {});

    /// The body as rigid, seated under the punch force, N: where contact begins as the force goes to zero. m, travel of the punch.
    double seat(double force);

    /// Of every node, m and rad times the rotation length, as last found.
    Vector displacement() const { return combine(false); }

    /// Equilibrium under a punch force > 0, N, until `residual` is at most `tolerance` or the space is full.
    Equilibrium solve(double force, double tolerance);

    /// Leaves this share of a bond's stiffness, which the network still has whole, to the body; its ends may press each other from
    /// now on. The network is left to the caller.
    void soften(std::size_t bond, double share, const PairContact& ends);

   private:
    static constexpr std::size_t rigid_motions = 3;  // lift, roll and pitch, the first fields; the other ones meet no contact

    struct Field {
        Vector displacement, force;  // force: stiffness times displacement; empty for a rigid motion
    };
    /// Pushes a node, and another one (-1: a wall) the opposite way, when the gap is closed.
    struct Contact {
        std::int32_t node, other;
        bool punch;
        Vec3 push;
        double gap, cosine, radius, modulus;
    };
    struct Forces {
        Eigen::VectorXd force, stiffness;
        double energy;
    };

    double closing(const Contact& contact, const Vector& displacement) const;
    double largest_closing(const Vector& displacement) const;
    void add_contact(const Contact& contact);
    bool add_closed_pairs(const Vector& displacement);
    void add_field(Field field);
    void start_anew();
    void add_response(const Vector& unbalanced, int& iterations);
    Forces forces_at(const Eigen::VectorXd& amplitude) const;
    Eigen::MatrixXd curvature(const Forces& forces) const;
    double energy(const Forces& forces, const Eigen::VectorXd& amplitude, double force) const;
    void minimise(double force);
    void touch_all(double force);
    Vector combine(bool forces) const;
    Vector unbalanced(const Forces& forces) const;
    void conclude(Equilibrium& state, const Forces& forces) const;

    const BondNetwork& network_;
    ElasticSolver* solver_;
    std::size_t walls_ = 0;  // contacts that are walls; pairs follow
    std::vector<Contact> contacts_;
    std::vector<PairContact> open_pairs_;
    std::vector<Field> fields_;
    Eigen::VectorXd amplitude_;  // of the punch travel, then of the fields, m
    Eigen::MatrixXd closing_;    // contact by amplitude: how much each closes it
    Eigen::MatrixXd stiffness_;  // of the bonds, amplitude by amplitude, N/m
};

}  // namespace kiln::mechanics
