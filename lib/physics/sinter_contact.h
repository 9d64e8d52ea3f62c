// sinter_contact.h: the law of a sintering contact. To change the law, change this file.
//
// Parhami & McMeeking 1998 and Bouvard & McMeeking 1996, as Eq. 1 of Dosta et al. 2017 states it for equal spheres, with R -> 2 R*
// for unequal ones. h overlap, m; R* = r1 r2/(r1 + r2), m; Delta diffusion parameter, m5/(N s); gamma surface energy, J/m2.
#pragma once

#include <cmath>
#include <numbers>

namespace kiln::physics {

/// Dimensionless constants of the contact.
struct ContactConstants {
    double alpha = 4.5;  // sintering force; Bouvard & McMeeking 1996: 9/2 for grain boundary to surface diffusion ratio 2
    double beta = 4.0;   // viscosities; the same source
    double eta = 0.01;   // tangential viscous friction
};

/// Reduced radius R* = r1 r2/(r1 + r2), m.
inline double reduced_radius(double first, double second) { return first * second / (first + second); }

/// Square of the contact radius, a^2 = 4 R* h (Coble; 2 R h for equal spheres), m2. Zero without overlap.
inline double contact_radius_squared(double overlap, double reduced) { return overlap > 0.0 ? 4.0 * reduced * overlap : 0.0; }

/// Overlap at which the contact radius is `neck` (m): the inverse of the law above, m.
inline double overlap_of_neck(double neck, double reduced) { return neck * neck / (4.0 * reduced); }

/// Attraction by surface energy, (alpha/beta) pi 2 R* gamma, N (second term of Eq. 1).
inline double sintering_force(const ContactConstants& c, double reduced, double surface_energy) {
    return c.alpha / c.beta * std::numbers::pi * 2.0 * reduced * surface_energy;
}

/// Normal viscosity times Delta over h^2: pi a^4/(2 beta) = K h^2 with K = pi (4 R*)^2/(2 beta), m2 (first term of Eq. 1).
inline double normal_viscosity_factor(const ContactConstants& c, double reduced) {
    return std::numbers::pi * 16.0 * reduced * reduced / (2.0 * c.beta);
}

/// The number, or zero for one below; Number: double or a vector of them.
template <typename Number>
inline Number positive(const Number& number) {
    const Number zero{};
    return number > zero ? number : zero;
}

/// How the normal viscosity grows with the overlap: h^2, m2. With its integral and the inverse of that below, the only place
/// where the power of h stands.
template <typename Number>
inline Number viscosity_shape(const Number& overlap) { return positive(overlap) * positive(overlap); }

/// Integral of viscosity_shape from one overlap to another, m3; K/Delta times it is the force times the time in which that alone
/// is overcome. Overlaps below zero count as zero.
inline double viscosity_integral(double from, double until) {
    const double a = from > 0.0 ? from : 0.0, b = until > 0.0 ? until : 0.0;
    return (b * b * b - a * a * a) / 3.0;
}

/// Mean of viscosity_shape between two overlaps, m2: the secant of its integral, finite where both are the same.
template <typename Number>
inline Number mean_viscosity_shape(Number one, Number other) {
    const Number a = positive(one), b = positive(other);
    return (a * a + a * b + b * b) * (1.0 / 3.0);
}

/// The overlap up to which viscosity_integral from `from` is `integral` (m3), m. Never below zero.
inline double overlap_of_integral(double from, double integral) {
    const double a = from > 0.0 ? from : 0.0, cube = a * a * a + 3.0 * integral;
    return cube > 0.0 ? std::cbrt(cube) : 0.0;
}

/// Tangential viscosity times Delta, eta pi a^2 (2 R*)^2/(2 beta), m4.
inline double tangential_viscosity(const ContactConstants& c, double overlap, double reduced) {
    return c.eta * std::numbers::pi * contact_radius_squared(overlap, reduced) * 4.0 * reduced * reduced / (2.0 * c.beta);
}

/// Overlap of an isolated pair after integral(Delta dt) = diffusion (m5/N) under the closing force (N): the exact solution
/// h^3 = h0^3 + 3 force diffusion/K of Eq. 1, m. Never below zero.
inline double pair_overlap(double overlap, double force, double diffusion, double viscosity_factor) {
    return overlap_of_integral(overlap, force * diffusion / viscosity_factor);
}

}  // namespace kiln::physics
