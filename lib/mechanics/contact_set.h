// contact_set.h: contacts of a body with rigid walls and with itself, as functions of the freedoms of a reduced space.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mechanics/particle_contacts.h"
#include "mechanics/reduced_space.h"
#include "mechanics/tangential_contacts.h"
#include "mechanics/wall_contact.h"

namespace kiln::mechanics {

/// Overlaps and slides of the contacts are linear in the freedoms (see ReducedSpace); their forces are Hertz's and, with friction,
/// those of tangential springs (TangentialContacts). Without friction the walls are rollers, which turn with the body: only the
/// share of their forces along z acts.
class ContactSet {
   public:
    /// pairs: all that may come to touch. friction: coefficient of all contacts. The network must outlive the set.
    ContactSet(const BondNetwork& network, const std::vector<WallContact>& walls, std::vector<PairContact> pairs, double friction);

    struct Forces {
        Eigen::VectorXd force, stiffness;  // along the normals: N, N/m
        Eigen::VectorXd friction;          // N, three a contact, on the other surface; none without friction
        double energy = 0.0;               // J, Hertz
        double potential = 0.0;            // J, the same and that of friction
    };
    Forces forces(const Eigen::VectorXd& freedoms) const;
    /// N, what the contacts do to each freedom, against it.
    Eigen::VectorXd resistance(const Forces& forces) const;
    /// Adds the derivative of the resistance by the freedoms, N/m.
    void add_stiffness(const Forces& forces, const Eigen::VectorXd& freedoms, Eigen::MatrixXd& matrix) const;
    /// Adds the forces and moments on the nodes (moments over the rotation length).
    void add_to_nodes(const Forces& forces, Vector& nodes) const;
    /// N, on the particle of every wall contact.
    std::vector<Vec3> on_walls(const Forces& forces) const;
    /// N, downwards, of the punch.
    double punch_force(const Forces& forces) const;
    /// Pairs that press each other.
    std::size_t closed_pairs(const Forces& forces) const;

    /// m, overlap of the contact that gets most of it where each carries the force (N) alone.
    double max_overlap(double force) const;
    /// How far a displacement closes or opens the contact that it moves most, m.
    double max_approach(const Vector& displacement) const;

    /// The space has one more field at its end, or no longer has fields [first, last).
    void add_field(const ReducedSpace& space, std::size_t field);
    void remove_fields(std::size_t first, std::size_t last);

    /// This pair may touch from now on.
    void add_pair(const PairContact& pair) { open_pairs_.push_back(pair); }
    /// Makes pairs contacts whose gap the displacement of the space has closed; false if there are none.
    bool add_closed_pairs(const ReducedSpace& space, const Vector& displacement);

    // Friction: see TangentialContacts.
    bool friction() const { return tangential_.active(); }
    bool undecided() const { return tangential_.undecided(); }
    void stick(double force) { tangential_.stick(force); }
    double follow(const Eigen::VectorXd& freedoms) { return tangential_.follow(overlaps(freedoms)); }
    void keep(const Eigen::VectorXd& freedoms);
    void release(const Eigen::VectorXd& freedoms);
    double stored(const Eigen::VectorXd& freedoms) const { return tangential_.stored(sliding_ * freedoms); }
    double lost(const Eigen::VectorXd& freedoms) const { return tangential_.lost(sliding_ * freedoms); }

   private:
    /// Pushes a node, and another one (-1: a wall) the opposite way, when the gap is closed.
    struct Contact {
        std::int32_t node, other;
        bool punch;
        Vec3 push;   // of the force on the node by the unit of the normal force
        double gap;  // m, along the push
        double radius, modulus, shear_modulus;
        Vec3 arm, other_arm;  // from the centres to where they touch, over the rotation length
    };

    /// What the nodes do that a contact joins.
    struct Moved {
        Vec6 node, other;
    };

    double approach(const Contact& contact, const Moved& moved) const;
    Vec3 slide(const Contact& contact, const Moved& moved) const;
    void add_rows(std::size_t contact, const ReducedSpace& space, std::size_t field);
    void add_contact(const Contact& contact);
    Eigen::VectorXd overlaps(const Eigen::VectorXd& freedoms) const;
    Vec3 on_node(const Forces& forces, std::size_t contact) const;

    double rotation_length_;
    std::size_t walls_;  // contacts that are walls; pairs follow
    std::vector<Contact> contacts_;
    std::vector<PairContact> open_pairs_;
    TangentialContacts tangential_;
    Eigen::MatrixXd approach_;  // contact by freedom: how much each closes it
    Eigen::MatrixXd sliding_;   // the same for slides, three rows a contact; none without friction
    Eigen::VectorXd kept_;      // freedoms of the last equilibrium that was kept
};

}  // namespace kiln::mechanics
