// hertz.h: Hertz contact of an elastic sphere with a rigid wall.
#pragma once

#include <cmath>

namespace kiln::physics {

/// Contact modulus of an elastic body against a rigid one, Pa: 1/E* = (1 - nu2)/E (Johnson, Contact Mechanics, 1985, Eq. 4.5).
inline double contact_modulus(double young_modulus, double poisson_ratio) {
    return young_modulus / (1.0 - poisson_ratio * poisson_ratio);
}

/// Energy, force and stiffness of one contact; all zero where the bodies do not touch.
struct HertzContact {
    double energy;     // J
    double force;      // N
    double stiffness;  // N/m
};

/// Sphere of radius R (m) pressed against a flat wall by the overlap h (m): F = (4/3) E* sqrt(R) h^(3/2)
/// (Johnson 1985, Eq. 4.23), its integral (8/15) E* sqrt(R) h^(5/2) and its derivative 2 E* sqrt(R h).
inline HertzContact hertz_contact(double contact_modulus, double radius, double overlap) {
    if (overlap <= 0.0) return {0.0, 0.0, 0.0};
    const double stiffness = 2.0 * contact_modulus * std::sqrt(radius * overlap);
    const double force = 2.0 / 3.0 * stiffness * overlap;
    return {0.4 * force * overlap, force, stiffness};
}

}  // namespace kiln::physics
