// tangential_contacts.h: friction of the contacts of a body that goes from one equilibrium to the next.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "physics/friction.h"

namespace kiln::mechanics {

/// A tangential spring for each contact, with what it has gone through. Forces of a step follow from how far the surfaces slid
/// since the last equilibrium that was kept, for a stiffness and a limit that are given beforehand and followed up: so each search
/// is for the minimum of a convex energy. A contact that closes within a step slides for its share of it.
class TangentialContacts {
   public:
    /// friction: coefficient, of all contacts.
    explicit TangentialContacts(double friction) : friction_(friction) {}

    bool active() const { return friction_ > 0.0; }

    /// Another contact, and where it was in the last equilibrium kept: overlap (m, negative for a gap) and slide (m). Radius (m)
    /// and moduli (Pa) as in hertz.h.
    void add(double radius, double modulus, double shear_modulus, double overlap, const Vec3& slide);

    /// Contacts that stick, each as stiff as one that carries the force (N): where the search for a first equilibrium begins.
    void stick(double force);

    /// True until such a search has begun, and again after a release.
    bool undecided() const { return undecided_; }

    /// Takes stiffness and limit of every contact from its overlap (m). Returns the largest change of a limit, N.
    double follow(const Eigen::VectorXd& overlap);

    /// Friction on the other surface by the slide of this one, m.
    physics::FrictionPotential potential(std::size_t contact, const Vec3& slide) const;

    /// J, where contacts have slid to (m, three a contact).
    double stored(const Eigen::VectorXd& slide) const;
    /// J, lost by then since the beginning.
    double lost(const Eigen::VectorXd& slide) const;

    /// The equilibrium counts as gone through.
    void keep(const Eigen::VectorXd& overlap, const Eigen::VectorXd& slide);

    /// All contacts part and begin anew from there; what was lost stays lost.
    void release(const Eigen::VectorXd& overlap, const Eigen::VectorXd& slide);

   private:
    struct Contact {
        double radius, modulus, shear_modulus;
        // In the last equilibrium kept:
        double overlap;
        Vec3 slide;
        physics::TangentialSpring spring;
        double last_limit = 0.0;
        // In this step:
        double stiffness = 0.0, limit = 0.0;
        double share = 1.0;           // of the slide, since the surfaces touched
        Vec3 carried = Vec3::Zero();  // m
    };

    static Vec3 displacement(const Contact& contact, const Vec3& slide);
    static Vec3 elastic(const Contact& contact, const Vec3& slide);

    double friction_;
    std::vector<Contact> contacts_;
    bool undecided_ = true;
    double lost_ = 0.0;  // J, until the last equilibrium kept
};

}  // namespace kiln::mechanics
