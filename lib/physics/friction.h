// friction.h: tangential force of a contact: a spring of Mindlin's stiffness that slips at Coulomb's limit.
#pragma once

#include <Eigen/Core>

#include "core/types.h"

namespace kiln::physics {

/// Tangential spring of a contact between two steps.
struct TangentialSpring {
    double stiffness = 0.0;       // N/m; zero: the bodies do not touch
    Vec3 displacement = Vec3::Zero();  // m, elastic

    double energy() const { return 0.5 * stiffness * displacement.squaredNorm(); }  // J
};

/// Elastic displacement, m, once the contact has become as stiff (N/m) as now, before anything slides: a contact that grows keeps
/// its force, since what newly touches was not there to be strained; one that shrinks keeps its displacement, and what parts lets
/// go of its force. Energy is lost either way, never made (Thornton, Cummins & Cleary 2013; `mindlin_rescale` of LAMMPS).
inline Vec3 carried_displacement(const TangentialSpring& spring, double stiffness) {
    return stiffness > spring.stiffness ? Vec3(spring.stiffness / stiffness * spring.displacement) : spring.displacement;
}

/// Of a displacement, m, what stays after slip at the limit of the force, N: radial return.
inline Vec3 elastic_displacement(const Vec3& displacement, double stiffness, double limit) {
    const double force = stiffness * displacement.norm();
    return force > limit ? Vec3(limit / force * displacement) : displacement;
}

/// Energy whose gradient by the displacement is the force: stored and, at the limit, spent by slip.
struct FrictionPotential {
    double energy;             // J
    Vec3 force;                // N
    Eigen::Matrix3d gradient;  // of the force, N/m
};

/// Convex in the displacement (m), for a given stiffness (N/m) and limit (N) of the contact.
inline FrictionPotential friction_potential(const Vec3& displacement, double stiffness, double limit) {
    const Vec3 elastic = elastic_displacement(displacement, stiffness, limit);
    const double length = displacement.norm(), slip = length - elastic.norm();
    FrictionPotential result{0.5 * stiffness * elastic.squaredNorm(), stiffness * elastic, stiffness * Eigen::Matrix3d::Identity()};
    if (slip <= 0.0) return result;
    const Vec3 along = displacement / length;
    result.energy += limit * slip;
    result.gradient = limit / length * (Eigen::Matrix3d::Identity() - along * along.transpose());
    return result;
}

}  // namespace kiln::physics
