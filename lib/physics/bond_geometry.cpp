// bond_geometry.cpp: length, volume and radius of the cylindrical bond between two spheres.
#include "physics/bond_geometry.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kiln::physics {

namespace {

using std::numbers::pi;

/// Height of the cap over a circle, R - sqrt(R^2 - Rb^2), written so that small circles lose no digits; m.
double cap_height(double radius, double circle_radius) {
    const double square = circle_radius * circle_radius;
    return square / (radius + std::sqrt(std::max(radius * radius - square, 0.0)));
}

/// Growth of the bond's volume with the square of its radius, m.
/// Cylinder: pi (L_b + Rb^2 dL_b/d(Rb^2)); without the caps every further shell adds its own length only: pi L_b.
double volume_slope(double distance, double radius1, double radius2, double bond_radius, BondVolume kind) {
    const double length = bond_length(distance, radius1, radius2, bond_radius);
    if (kind == BondVolume::cap_corrected) return pi * length;
    const double square = bond_radius * bond_radius;
    const auto lengthening = [&](double radius) { return 0.5 / std::sqrt(std::max(radius * radius - square, 0.0)); };
    return pi * (length + square * (lengthening(radius1) + lengthening(radius2)));
}

}  // namespace

double bond_length(double distance, double radius1, double radius2, double bond_radius) {
    return (distance - radius1 - radius2) + cap_height(radius1, bond_radius) + cap_height(radius2, bond_radius);
}

double cap_volume(double radius, double circle_radius) {
    const double height = cap_height(radius, circle_radius);
    return pi / 3.0 * height * height * (3.0 * radius - height);
}

double bond_volume(double distance, double radius1, double radius2, double bond_radius, BondVolume kind) {
    const double cylinder = pi * bond_radius * bond_radius * bond_length(distance, radius1, radius2, bond_radius);
    if (kind == BondVolume::cylinder) return cylinder;
    return cylinder - cap_volume(radius1, bond_radius) - cap_volume(radius2, bond_radius);
}

double bond_radius(double volume, double distance, double radius1, double radius2, BondVolume kind) {
    const double largest = std::min(radius1, radius2);
    if (volume <= 0.0) return 0.0;
    if (volume >= bond_volume(distance, radius1, radius2, largest, kind)) return largest;

    // Newton's method in the square of the radius, kept between bounds; the first guess is the root for low caps,
    // pi (gap x + x^2 (1/R1 + 1/R2)/2) = volume, which is never below the cylinder's.
    const double gap = std::max(distance - radius1 - radius2, 0.0);
    const double curvature = 1.0 / radius1 + 1.0 / radius2;
    double lower = 0.0;
    double upper = largest * largest;
    double square = 2.0 * volume / pi / (gap + std::sqrt(gap * gap + 2.0 * curvature * volume / pi));
    for (int iteration = 0; iteration < 200; ++iteration) {
        if (!(square > lower && square < upper)) square = 0.5 * (lower + upper);
        const double radius = std::sqrt(square);
        const double excess = bond_volume(distance, radius1, radius2, radius, kind) - volume;
        (excess > 0.0 ? upper : lower) = square;
        const double change = excess / volume_slope(distance, radius1, radius2, radius, kind);
        square -= change;
        if (std::abs(change) <= 1e-15 * square) break;
    }
    return std::min(std::sqrt(std::max(square, 0.0)), largest);
}

}  // namespace kiln::physics
