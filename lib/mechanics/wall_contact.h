// wall_contact.h: equilibrium of a bonded body between rigid supports below and a rigid punch above.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mechanics/elastic_solver.h"

namespace kiln::mechanics {

/// A particle that one of the rigid bodies may touch. Contacts act along z: rollers turn with the body, so that no horizontal force
/// remains. Hertz force at the overlap along the normal, and its share along z.
struct WallContact {
    std::int32_t node;
    std::int32_t cylinder;
    bool punch;            // pressed from above by the punch, else from below by a support
    double gap;            // m, along z, at rest with the punch travel zero
    double cosine;         // of the angle between the contact normal and z
    double radius;         // m, of the particle
    double modulus;        // Pa, contact modulus
    double shear_modulus;  // Pa, the same for Mindlin's stiffness
};

/// Rigid cylinder along y, where it stands when it just touches the body; m.
struct Cylinder {
    double x, z;  // of its axis
    double radius;
    bool punch;  // moves downwards with the punch
};

/// The rigid bodies and all particles that may touch them.
struct Tooling {
    std::vector<Cylinder> cylinders;
    std::vector<WallContact> contacts;
};

struct Equilibrium {
    Vector displacement;                // of every node
    double punch = 0.0;                 // m, travel of the punch downwards
    double punch_compliance = 0.0;      // m/N, d punch / d force
    std::vector<double> contact_force;  // N, along z, one per contact, never negative
    double bond_energy = 0.0;           // J
    double contact_energy = 0.0;        // J
    int iterations = 0;                 // of the linear solver, since the last equilibrium
    double residual = 0.0;              // norm of the unbalanced forces over that of the contact forces
    bool converged = false;
};

/// Finds equilibria under rising or falling punch forces. Total energy (bonds, Hertz contacts, punch) is convex. It is minimised
/// over a growing space of displacement fields: first the body's rigid motions in the field of the contacts, then, one by one, the
/// elastic response to the forces that the last minimum left unbalanced. The bonds' matrix is preconditioned once; a minimum in the
/// space is a small dense problem; the space serves all forces.
class ContactProblem {
 public:
    /// solver: null for a body that is only seated.
    ContactProblem(const BondNetwork& network, ElasticSolver* solver, std::vector<WallContact> contacts);

    /// The body as rigid, seated under the punch force, N: where contact begins as the force goes to zero. m, travel of the punch.
    double seat(double force);

    /// Of every node, m and rad times the rotation length, as last found.
    Vector displacement() const { return combine(false); }

    /// Equilibrium under a punch force > 0, N, until `residual` is at most `tolerance` or the space has `most_fields` fields.
    Equilibrium solve(double force, double tolerance);

 private:
    struct Field {
        Vector displacement, force;  // force: stiffness times displacement; empty for a rigid motion
        double stiffness;            // displacement . force, N/m
    };
    struct Contacts {
        Eigen::VectorXd force, stiffness;
        double energy;
    };

    void add_field(Field field);
    void add_response(const Vector& unbalanced, int& iterations);
    Contacts contacts_at(const Eigen::VectorXd& amplitude) const;
    Eigen::MatrixXd curvature(const Contacts& contacts) const;
    double energy(const Contacts& contacts, const Eigen::VectorXd& amplitude, double force) const;
    void minimise(double force);
    void touch_all(double force);
    Vector combine(bool forces) const;

    const BondNetwork& network_;
    ElasticSolver* solver_;
    std::vector<WallContact> contacts_;
    std::vector<Field> fields_;
    Eigen::VectorXd amplitude_;  // of the punch travel, then of the fields, m
    Eigen::MatrixXd closing_;    // contact by amplitude: how much each closes it
};

}  // namespace kiln::mechanics
