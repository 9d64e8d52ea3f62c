// friction.h: tangential force of a contact: a spring of Mindlin's stiffness that slips at Coulomb's limit.
#pragma once

#include <Eigen/Core>

#include "core/types.h"

namespace kiln::physics {

/// Tangential spring of a contact between two steps.
struct Grip {
    double stiffness = 0.0;       // N/m; zero: the bodies do not touch
    Vec3 stretch = Vec3::Zero();  // m

    double energy() const { return 0.5 * stiffness * stretch.squaredNorm(); }  // J
};

/// Stretch, m, once the contact has become as stiff (N/m) as now, before anything slides: a contact that grows keeps its force,
/// since what newly touches was not there to be strained; one that shrinks keeps its stretch, and what parts lets go of its force.
/// Energy is lost either way, never made (Thornton, Cummins & Cleary 2013; `mindlin_rescale` of LAMMPS).
inline Vec3 carried_stretch(const Grip& grip, double stiffness) {
    return stiffness > grip.stiffness ? Vec3(grip.stiffness / stiffness * grip.stretch) : grip.stretch;
}

/// Of a stretch, m, what stays after slip at the limit of the force, N: radial return.
inline Vec3 held_stretch(const Vec3& stretch, double stiffness, double limit) {
    const double force = stiffness * stretch.norm();
    return force > limit ? Vec3(limit / force * stretch) : stretch;
}

/// Energy whose gradient by the stretch is the force: stored and, at the limit, spent by slip.
struct FrictionPotential {
    double energy;             // J
    Vec3 force;                // N
    Eigen::Matrix3d gradient;  // of the force, N/m
};

/// Convex in the stretch (m), for a given stiffness (N/m) and limit (N) of the contact.
inline FrictionPotential friction_potential(const Vec3& stretch, double stiffness, double limit) {
    const Vec3 held = held_stretch(stretch, stiffness, limit);
    const double length = stretch.norm(), slip = length - held.norm();
    FrictionPotential result{0.5 * stiffness * held.squaredNorm(), stiffness * held, stiffness * Eigen::Matrix3d::Identity()};
    if (slip <= 0.0) return result;
    const Vec3 along = stretch / length;
    result.energy += limit * slip;
    result.gradient = limit / length * (Eigen::Matrix3d::Identity() - along * along.transpose());
    return result;
}

}  // namespace kiln::physics
