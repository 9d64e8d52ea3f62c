// coarsening.h: how neighbouring grains of unequal size exchange volume. To change the laws, change this file.
//
// Two grains, small and large their radii, m; a < small the radius of their neck, m. Two mechanisms, which Paredes-Goyes et al.
// (Acta Materialia 2021) name; the equations here are derived anew. Surface diffusion carries volume from the more curved surface
// to the less curved one, over the neck; the boundary migrates towards the centre of the smaller grain. Volume goes from small to
// large, and none between equals. gamma surface energy, J/m2; psi dihedral angle, rad; D_s' = Omega delta_s D_s/(k_B T), m6/(J s);
// M mobility of the boundary, m4/(J s).
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "physics/sinter_contact.h"

namespace kiln::physics {

/// Necks stay narrower than the smaller grain by this part of it: a grain that is all neck has no surface.
inline constexpr double neck_clip = 1e-6;

/// A boundary counts as free from chi times the smaller radius on, less this part of it: more than neck_clip, so that chi = 1
/// occurs.
inline constexpr double neck_slack = 2e-6;

/// Energy of a grain boundary, 2 gamma cos(psi/2), J/m2 (Young's equation).
inline double boundary_energy(double surface_energy, double dihedral_angle) {
    return 2.0 * surface_energy * std::cos(0.5 * dihedral_angle);
}

/// Largest neck at equilibrium, m: the circle in which two spheres meet at the dihedral angle, small large sin(psi)/sqrt(small^2 +
/// large^2 + 2 small large cos(psi)), up to the ratio of sizes -1/cos(psi) at which it is as wide as the smaller grain, and small
/// beyond. sine: sin(psi/2); of 1 or more: no limit but the grain.
inline double equilibrium_neck(double small, double large, double sine) {
    const double widest = (1.0 - neck_clip) * small;
    if (!(sine < 1.0)) return widest;
    const double cosine = 1.0 - 2.0 * sine * sine;
    if (-cosine * large >= small) return widest;
    const double square = small * small + large * large + 2.0 * small * large * cosine;
    return std::min(widest, small * large * 2.0 * sine * std::sqrt(1.0 - sine * sine) / std::sqrt(square));
}

/// Resistance of the surface of one grain to the flow from its cap to the neck: I(u) = [2 ln(2/(1 - u)) - (1 + u)]/(2 pi (1 +
/// u)^2), u = sqrt(1 - (a/r)^2), for a flow that gathers evenly on the sphere.
inline double surface_resistance(double neck, double radius) {
    const double x = std::min(neck / radius, 1.0 - neck_clip), u = std::sqrt((1.0 - x) * (1.0 + x));
    const double less = x * x / (1.0 + u);  // 1 - u, with all its digits
    return (2.0 * std::log(2.0 / less) - (1.0 + u)) / (2.0 * std::numbers::pi * (1.0 + u) * (1.0 + u));
}

/// Volume that goes from small to large by surface diffusion in a time t, over gamma D_s' t, 1/m: 2 (1/small - 1/large)/(I + I).
inline double surface_flow(double small, double large, double neck) {
    return 2.0 * (1.0 / small - 1.0 / large) / (surface_resistance(neck, small) + surface_resistance(neck, large));
}

/// Volume that goes from small to large by migration of their boundary in a time t, over M gamma_gb t, m: pi a^2 kappa, where kappa
/// = (2/a) sin([asin(a/small) - asin(a/large)]/2) is the curvature of a boundary that meets both surfaces at the same angle.
inline double boundary_flow(double small, double large, double neck) {
    const double a = std::min(neck, (1.0 - neck_clip) * small);
    return 2.0 * std::numbers::pi * a * std::sin(0.5 * (std::asin(a / small) - std::asin(a / large)));
}

/// Part of its volume that a grain gives away in a step, from the outflows at its start times the step over its volume, by surface
/// and by boundary. Exact for one mechanism alone, whose flow goes with the power -1/3 or 1/3 of the volume; never above 1.
inline double fraction_given(double surface, double boundary) {
    const double both = surface + boundary;
    if (!(both > 0.0)) return 0.0;
    const double power = (4.0 * surface + 2.0 * boundary) / (3.0 * both);
    return 1.0 - std::pow(std::max(0.0, 1.0 - power * both), 1.0 / power);
}

/// The same the other way round: how many times the outflows may be for the part `fraction`.
inline double times_for_fraction(double surface, double boundary, double fraction) {
    const double both = surface + boundary, power = (4.0 * surface + 2.0 * boundary) / (3.0 * both);
    return (1.0 - std::pow(1.0 - fraction, power)) / (power * both);
}

/// Neck of a pair after its grains changed by so much in radius (m), their reduced radius now being `reduced`, m. A grain that
/// shrinks keeps its neck; one that grows buries the part `share` of its growth in the overlap (1/2 for truncated spheres).
inline double neck_after(double neck, double reduced, double first_change, double second_change, double share) {
    const double growth = std::max(0.0, first_change) + std::max(0.0, second_change);
    if (growth == 0.0) return neck;
    return std::sqrt(contact_radius_squared(overlap_of_neck(neck, reduced) + share * growth, reduced));
}

/// Neck that surface diffusion alone has grown, m: (a/R)^7 = (a0/R)^7 + 56 gamma D_s' t/R^4 (G. C. Kuczynski, Trans. AIME 185,
/// 1949, 169), R -> 2 R*. diffusion: gamma D_s' t, m4.
inline double neck_by_surface(double neck, double reduced, double diffusion) {
    const double radius = 2.0 * reduced;
    return radius * std::pow(std::pow(neck / radius, 7.0) + 56.0 * diffusion / std::pow(radius, 4.0), 1.0 / 7.0);
}

}  // namespace kiln::physics
