// explicit_contacts.h: Hertz-Mindlin contacts of moving spheres with each other and with rigid cylinders.
#pragma once

#include "mechanics/particle_contacts.h"
#include "mechanics/wall_contact.h"
#include "physics/friction.h"

namespace kiln::mechanics {

/// Contacts of a body without periodic axes. The force across a contact is that of a spring between where the surfaces first stuck
/// together and where they are, with Mindlin's stiffness at the overlap of the moment; the spring slips where its force would
/// exceed the friction coefficient times the normal force (see physics/friction.h). Without friction the cylinders are rollers that
/// follow the body along x: only the vertical part of their forces acts.
class ExplicitContacts {
   public:
    /// The network must outlive the contacts.
    ExplicitContacts(const BondNetwork& network, std::vector<ElasticSphere> spheres, Tooling tooling, double friction);

    /// Adds the forces to those of the nodes (moments over the rotation length) after a step of dt (s) with the velocities of the
    /// nodes and of the punch (m/s, downwards) that ended at the displacements and at the travel of the punch (m).
    void add_forces(const Vector& displacement, const Vector& velocity, double travel, double punch_velocity, double dt,
                    Vector& force);

    double punch_force() const { return punch_force_; }  // N, downwards
    double energy() const { return energy_; }            // J, stored
    double friction_loss() const { return loss_; }       // J, since the beginning
    /// N, on the particles, of every contact with a cylinder, as they stand in the tooling.
    const std::vector<Vec3>& wall_forces() const { return wall_force_; }
    std::size_t touching_pairs() const { return touching_pairs_; }
    /// Pairs that may touch, as of now.
    const std::vector<PairContact>& pairs() const { return pairs_; }

   private:
    struct Touch {
        Vec3 normal;     // from the sphere outwards
        double overlap;  // m
        double radius, modulus, shear_modulus;
    };

    void search(const Vector& displacement);
    double farthest_since_search(const Vector& displacement) const;
    void add_pairs(const Vector& displacement, const Vector& velocity, double dt, Vector& force);
    void add_walls(const Vector& displacement, const Vector& velocity, double travel, double punch_velocity, double dt,
                   Vector& force);
    Vec3 friction_force(const Touch& touch, const Vec3& slide, physics::TangentialSpring& spring);

    const BondNetwork& network_;
    std::vector<ElasticSphere> spheres_;
    Tooling tooling_;
    double friction_, margin_;
    std::vector<PairContact> pairs_;
    std::vector<double> overlap_;  // of the pairs, m
    std::vector<physics::TangentialSpring> pair_spring_, wall_spring_;
    std::vector<Vec3> wall_force_;
    Vector searched_at_;  // displacements at the last search
    double punch_force_ = 0.0, energy_ = 0.0, loss_ = 0.0;
    std::size_t touching_pairs_ = 0;
};

}  // namespace kiln::mechanics
