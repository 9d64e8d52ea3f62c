// hertz.h: contact of elastic spheres with each other and with rigid walls: Hertz along the normal, Mindlin across it.
#pragma once

#include <cmath>

namespace kiln::physics {

/// Contact modulus of an elastic body against a rigid one, Pa: 1/E* = (1 - nu2)/E (Johnson, Contact Mechanics, 1985, Eq. 4.5).
inline double contact_modulus(double young_modulus, double poisson_ratio) {
    return young_modulus / (1.0 - poisson_ratio * poisson_ratio);
}

/// Shear modulus of such a contact, Pa: 1/G* = (2 - nu)/G (Johnson 1985, section 7.2).
inline double contact_shear_modulus(double young_modulus, double poisson_ratio) {
    return young_modulus / (2.0 * (1.0 + poisson_ratio) * (2.0 - poisson_ratio));
}

/// Two moduli, or two radii, of a contact between two bodies: 1/x = 1/a + 1/b (Johnson 1985, Eq. 4.5 and 4.17).
inline double in_contact(double a, double b) { return a * b / (a + b); }

/// Energy, force and stiffness of one contact; all zero where the bodies do not touch.
struct HertzContact {
    double energy;     // J
    double force;      // N
    double stiffness;  // N/m
};

/// Sphere of radius R (m) pressed against a flat wall, or two spheres of the reduced radius R, by the overlap h (m):
/// F = (4/3) E* sqrt(R) h^(3/2) (Johnson 1985, Eq. 4.23), its integral (8/15) E* sqrt(R) h^(5/2) and its derivative 2 E* sqrt(R h).
inline HertzContact hertz_contact(double contact_modulus, double radius, double overlap) {
    if (overlap <= 0.0) return {0.0, 0.0, 0.0};
    const double stiffness = 2.0 * contact_modulus * std::sqrt(radius * overlap);
    const double force = 2.0 / 3.0 * stiffness * overlap;
    return {0.4 * force * overlap, force, stiffness};
}

/// Overlap that carries the force (N), m: the inverse of hertz_contact.
inline double hertz_overlap(double contact_modulus, double radius, double force) {
    return std::cbrt(9.0 / 16.0 * force * force / (contact_modulus * contact_modulus * radius));
}

/// Tangential stiffness without slip, N/m: 8 G* a with a = sqrt(R h) (Mindlin 1949; Johnson 1985, section 7.2).
inline double mindlin_stiffness(double contact_shear_modulus, double radius, double overlap) {
    return overlap > 0.0 ? 8.0 * contact_shear_modulus * std::sqrt(radius * overlap) : 0.0;
}

}  // namespace kiln::physics
