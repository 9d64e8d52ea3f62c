// contact_problem.h: equilibrium of a bonded body between rigid supports below and a rigid punch above.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mechanics/contact_grips.h"
#include "mechanics/elastic_solver.h"
#include "mechanics/particle_contacts.h"
#include "mechanics/wall_contact.h"

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

/// Finds equilibria under rising or falling punch forces. Total energy (bonds, Hertz contacts, punch) is convex. It is minimised
/// over a growing space of displacement fields: first the body's rigid motions in the field of the contacts, then, one by one, the
/// elastic response to the forces that the last minimum left unbalanced. The bonds' matrix is preconditioned once; a minimum in the
/// space is a small dense problem; the space serves all forces. Contacts between particles enter where their gap has closed.
/// Without friction the rigid bodies are rollers, which turn with the body: only the share of their forces along z acts. With
/// friction (ContactGrips) each minimum is found for given limits of the tangential forces, which are then taken anew from the
/// normal forces until they no longer change: all matrices stay symmetric.
class ContactProblem {
   public:
    /// solver: null for a body that is only seated. pairs: all that may come to touch. friction: coefficient of all contacts. The
    /// network must outlive the problem.
    ContactProblem(const BondNetwork& network, ElasticSolver* solver, const std::vector<WallContact>& walls,
                   std::vector<PairContact> pairs = {}, double friction = 0.0);

    /// The body as rigid, seated under the punch force, N, without sliding along x or y: where contact begins as the force goes to
    /// zero. m, travel of the punch. To be called once, before all equilibria.
    double seat(double force);

    /// Of every node, m and rad times the rotation length, as last found.
    Vector displacement() const { return combine(false); }

    /// Equilibrium under a punch force > 0, N, until `residual` is at most `tolerance` or the space is full.
    Equilibrium solve(double force, double tolerance);

    /// Equilibrium with the punch held where it is, such as after a bond broke; force: the last one, N, as a measure.
    Equilibrium relax(double force, double tolerance);

    /// The last equilibrium counts as gone through: friction of those to come starts from there.
    void keep();

    /// The punch and with it all force is gone; loading begins anew.
    void release();

    double friction_loss() const { return grips_.lost(slides()); }  // J, since the beginning

    /// Leaves this share of a bond's stiffness, which the network still has whole, to the body; its ends may press each other from
    /// now on. The network is left to the caller.
    void soften(std::size_t bond, double share, const PairContact& ends);

   private:
    struct Field {
        Vector displacement, force;  // force: stiffness times displacement; empty for a rigid motion
    };
    /// What drives the punch.
    struct Drive {
        double force;  // N; of a punch that is held, only a measure
        bool held = false;
    };
    /// Pushes a node, and another one (-1: a wall) the opposite way, when the gap is closed.
    struct Contact {
        std::int32_t node, other;
        bool punch;
        Vec3 push;   // of the force on the node by the unit of the normal force
        double gap;  // m, along the push
        double radius, modulus, shear_modulus;
        Vec3 arm, other_arm;  // from the centres to where they touch, over the rotation length
    };
    struct Forces {
        Eigen::VectorXd force, stiffness;  // along the normals: N, N/m
        Eigen::VectorXd friction;          // N, three a contact, on the other surface
        double energy = 0.0;               // J, Hertz
        double potential = 0.0;            // J, the same and that of friction
    };

    void add_rigid_motion(const Vec3& shift, const Vec3& turn);
    double closing(const Contact& contact, const Vector& displacement) const;
    Vec3 sliding(const Contact& contact, const Vector& displacement) const;
    Vec3 sliding_with_punch(const Contact& contact) const;
    void add_rows(std::size_t contact, Eigen::Index column, const Vector& displacement);
    Eigen::VectorXd overlaps() const;
    Eigen::VectorXd slides() const { return sliding_ * amplitude_; }
    double largest_closing(const Vector& displacement) const;
    void add_contact(const Contact& contact);
    bool add_closed_pairs(const Vector& displacement);
    void add_field(Field field);
    void remove_last_field();
    void start_anew();
    void add_response(const Vector& unbalanced, int& iterations);
    Forces forces_at(const Eigen::VectorXd& amplitude) const;
    Eigen::MatrixXd curvature(const Forces& forces, const Eigen::VectorXd& amplitude) const;
    double bond_energy(const Eigen::VectorXd& amplitude) const { return 0.5 * amplitude.dot(stiffness_ * amplitude); }
    void minimise(const Drive& drive);
    bool settle(const Drive& drive, double tolerance);
    Equilibrium search(const Drive& drive, double tolerance);
    void touch_all(double force);
    Vector combine(bool forces) const;
    Vec3 force_on_node(const Forces& forces, std::size_t contact) const;
    Vector unbalanced(const Forces& forces) const;
    void conclude(Equilibrium& state, const Forces& forces, const Drive& drive) const;

    const BondNetwork& network_;
    ElasticSolver* solver_;
    std::size_t walls_ = 0;  // contacts that are walls; pairs follow
    std::vector<Contact> contacts_;
    std::vector<PairContact> open_pairs_;
    std::vector<Field> fields_;
    std::size_t rigid_motions_ = 0;  // the first fields: lift, roll and pitch; with friction the other three
    ContactGrips grips_;
    Eigen::VectorXd amplitude_;  // of the punch travel, then of the fields, m
    Eigen::VectorXd kept_;       // the same in the last equilibrium that was kept
    Eigen::VectorXd seated_;     // the same, without load; only the first ones
    bool gripped_ = false;       // a first guess of the grips is there
    Eigen::MatrixXd closing_;    // contact by amplitude: how much each closes it
    Eigen::MatrixXd sliding_;    // the same for slides, three rows a contact; none without friction
    Eigen::MatrixXd stiffness_;  // of the bonds, amplitude by amplitude, N/m
};

}  // namespace kiln::mechanics
