// neck.h: geometry of the neck that sintering leaves between two overlapping spheres.
//
// The spheres keep their radii R1, R2 (m) and their distance d (m) < R1 + R2. The neck is a cylinder about the line of centres that
// begins and ends where the spheres have its radius; what of it lies inside the spheres is theirs.
#pragma once

#include "core/state.h"

namespace kiln::physics {

/// Largest neck radius over the smaller sphere's at equilibrium of grain boundary and surface, sin(psi/2) of the dihedral angle
/// psi (Bouvard & McMeeking 1996); infinity for a material without one.
double neck_limit(const Material& material);

/// Distance from the first centre to the plane of the circle in which two spheres meet, m: (d^2 + R1^2 - R2^2)/(2 d). Negative or
/// above d where one sphere is sunk into the other beyond its centre.
double meeting_plane(double distance, double radius1, double radius2);

/// Radius of the circle in which two spheres meet, m; zero for spheres that do not overlap, the smaller radius for one that is sunk
/// into the other beyond its centre.
double meeting_radius(double distance, double radius1, double radius2);

/// Neck radius, m, where a law or a record says `neck` (m): no more than max_radius (m), no less than the circle in which the
/// spheres meet, and never more than the smaller radius.
double neck_radius(double neck, double distance, double radius1, double radius2, double max_radius);

/// Neck length, m: L = d - sqrt(R1^2 - a^2) - sqrt(R2^2 - a^2); zero where the spheres meet in the circle of that radius or in a
/// wider one.
double neck_length(double distance, double radius1, double radius2, double neck_radius);

}  // namespace kiln::physics
