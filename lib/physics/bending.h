// bending.h: Young's modulus from a three-point bending test of a rectangular bar.
//
// Deflection under the load, Timoshenko beam with shear coefficient 5/6: F L^3/(48 E I) + F L/(4 (5/6) G A) with I = b h^3/12,
// A = b h, G = E/(2 (1 + nu)). Source: S. P. Timoshenko, Strength of Materials, part I, effect of shear on deflection.
#pragma once

#include <cmath>

namespace kiln::physics {

/// Factor by which shear softens the bar: 1 + 2.4 (1 + nu) (h/L)^2; height h and span L in m.
inline double shear_correction(double height, double span, double poisson_ratio) {
    const double slenderness = height / span;
    return 1.0 + 2.4 * (1.0 + poisson_ratio) * slenderness * slenderness;
}

/// Young's modulus, Pa, of a slender bar, whose shear does not count: E = S L^3/(4 b h^3).
/// slope S: force over deflection under the load, N/m; span L, width b, height h in m.
inline double slender_modulus(double slope, double span, double width, double height) {
    return slope * span * span * span / (4.0 * width * height * height * height);
}

/// The same, shear included: E = S L^3/(4 b h^3) [1 + 2.4 (1 + nu) (h/L)^2].
inline double bending_modulus(double slope, double span, double width, double height, double poisson_ratio) {
    return slender_modulus(slope, span, width, height) * shear_correction(height, span, poisson_ratio);
}

/// Span, m, of the bar that would show the same deflection with its forces at the ends of the span. Here the supports' resultant
/// forces act a distance `held` apart, and the deflection under the load is read against the bar above two points a distance `read`
/// apart: F/(48 E I) (held^3 + 3/2 held^2 (read - held)), the bar being straight beyond its supports.
inline double equivalent_span(double held, double read) { return std::cbrt(held * held * (1.5 * read - 0.5 * held)); }

/// Bending strength, Pa: the stress that the greatest force F (N) would cause at the lower face of an elastic bar,
/// 3 F (L - Li)/(2 b h^2); span L, width b, height h in m, Li the distance between two points of load, 0 for one (ASTM C1161: three
/// points, and a quarter of four points with Li = L/2).
inline double bending_strength(double force, double span, double width, double height, double inner_span = 0.0) {
    return 1.5 * force * (span - inner_span) / (width * height * height);
}

}  // namespace kiln::physics
