// wall_contact.h: rigid cylinders below and above a body, and the particles that they may touch.
#pragma once

#include <cstdint>
#include <vector>

#include "core/types.h"

namespace kiln::mechanics {

/// A particle that one of the rigid bodies may touch.
struct WallContact {
    std::int32_t node;
    std::int32_t cylinder;
    bool punch;            // pressed from above by the punch, else from below by a support
    double gap;            // m, along z, at rest with the punch travel zero
    Vec3 normal;           // from the cylinder to the particle where they touch
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

}  // namespace kiln::mechanics
