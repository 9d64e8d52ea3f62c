// explicit_motion.h: motion of a bonded body by explicit time integration, as the discrete element method does it.
#pragma once

#include <vector>

#include "mechanics/connectivity.h"
#include "mechanics/explicit_contacts.h"
#include "physics/bond_motion.h"

namespace kiln::mechanics {

struct MotionModel {
    double damping = 0.0;         // of the unbalanced force, against the velocity (Cundall 1987): below 1, without unit
    double friction = 0.0;        // coefficient of all contacts
    double max_force = 0.0;  // N, that one contact may come to carry: what the time step is chosen for
};

/// Where the work of the punch has gone; J.
struct MotionEnergy {
    double work = 0.0;      // of the punch
    double bonds = 0.0;     // stored
    double contacts = 0.0;  // stored
    double kinetic = 0.0;
    double damping = 0.0;   // dissipated
    double friction = 0.0;  // dissipated
    double total() const { return bonds + contacts + kinetic + damping + friction; }
};

/// Leapfrog: velocities half a step behind displacements. Bonds by physics/bond_motion.h, contacts by ExplicitContacts. Every sum
/// has its order, so the number of threads does not change a bit.
class ExplicitMotion {
   public:
    /// A network without periodic axes that outlives the motion; mass of every node, kg, of spheres with the moment of inertia
    /// (2/5) m r^2.
    ExplicitMotion(const BondNetwork& network, std::vector<ElasticSphere> spheres, const std::vector<double>& mass,
                   const Tooling& tooling, const MotionModel& model);

    /// s: 0.8 times 2/omega, where omega^2 is at most twice the largest eigenvalue of the nodes' own 6x6 stiffness over their mass:
    /// every spring has two ends.
    double time_step() const { return time_step_; }

    /// Puts the unstrained body and the punch where the motion begins, at rest; rotations are those of the whole body.
    void place(const Vector& displacement, double travel);

    /// One step with the punch at a velocity (m/s, downwards).
    void step(double punch_velocity);

    const Vector& displacement() const { return displacement_; }
    double travel() const { return travel_; }  // of the punch, m
    const ExplicitContacts& contacts() const { return contacts_; }
    MotionEnergy energy() const;
    std::vector<BondLoad> loads() const;

   private:
    void choose_time_step(const std::vector<WallContact>& walls, double max_force);
    void kick_and_drift();
    void move_bonds();
    void gather();

    const BondNetwork& network_;
    Grouping<std::int32_t> incidence_;
    std::vector<Vec6> inverse_mass_;  // 1/kg, rotations over the square of the rotation length
    MotionModel model_;
    ExplicitContacts contacts_;
    double time_step_ = 0.0;
    Vector displacement_, velocity_, force_;
    std::vector<physics::BondHold> hold_;
    std::vector<Vec3> bond_force_, shear_moment_;  // N on the first node; N m on both
    std::vector<double> damped_;                 // J, dissipated at each node
    double travel_ = 0.0, punch_velocity_ = 0.0, work_ = 0.0;
};

}  // namespace kiln::mechanics
