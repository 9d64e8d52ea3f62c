// neck.cpp: geometry of the neck that sintering leaves between two overlapping spheres.
#include "physics/neck.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "physics/bond_geometry.h"

namespace kiln::physics {

double neck_limit(const Material& material) {
    return material.dihedral_angle ? std::sin(0.5 * *material.dihedral_angle) : std::numeric_limits<double>::infinity();
}

double meeting_plane(double distance, double radius1, double radius2) {
    return 0.5 * (distance + (radius1 - radius2) * (radius1 + radius2) / distance);
}

double meeting_radius(double distance, double radius1, double radius2) {
    if (distance >= radius1 + radius2) return 0.0;
    const double plane = meeting_plane(distance, radius1, radius2);
    if (plane <= 0.0 || plane >= distance) return std::min(radius1, radius2);
    return std::sqrt(std::max(0.0, (radius1 - plane) * (radius1 + plane)));
}

double neck_radius(double neck, double distance, double radius1, double radius2, double max_radius) {
    return std::max(std::min({neck, max_radius, radius1, radius2}), meeting_radius(distance, radius1, radius2));
}

double neck_length(double distance, double radius1, double radius2, double neck_radius) {
    if (neck_radius <= meeting_radius(distance, radius1, radius2)) return 0.0;
    return std::max(0.0, bond_length(distance, radius1, radius2, neck_radius));
}

}  // namespace kiln::physics
