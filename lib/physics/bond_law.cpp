// bond_law.cpp: compliance integrals of bonds and truncated spheres, and the springs made of them.
#include "physics/bond_law.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "physics/solid_law.h"

namespace kiln::physics {

using std::numbers::pi;

namespace {

double square(double value) { return value * value; }

/// Cylinder of radius r and length l, m, seen from its middle.
BondCompliance cylinder_compliance(double r, double l) {
    const double area = pi * square(r);
    const double inertia = area * square(r) / 4.0;
    return {l / area, l / inertia, l * square(l) / (12.0 * inertia)};
}

BondCompliance sum(const BondCompliance& a, const BondCompliance& b) {
    return {a.stretching + b.stretching, a.bending + b.bending, a.transverse + b.transverse};
}

}  // namespace

BondCompliance sphere_compliance(double sphere_radius, double bond_radius, double arm) {
    const double R = sphere_radius;
    const double Rb = std::min(bond_radius, R);
    const double s = std::sqrt((R - Rb) * (R + Rb));
    const double logarithm = std::log((R + s) / Rb);  // atanh(s/R), exact also where s/R rounds to 1
    // Moments of 1/(R2 - t2)2 over t in [0, s].
    const double zeroth = s / (2.0 * square(R * Rb)) + logarithm / (2.0 * R * square(R));
    const double first = square(s / (R * Rb)) / 2.0;
    const double second = s / (2.0 * square(Rb)) - logarithm / (2.0 * R);
    const double c = s + arm;
    return {logarithm / (pi * R), 4.0 / pi * zeroth, 4.0 / pi * (square(c) * zeroth - 2.0 * c * first + second)};
}

BondCompliance bond_compliance(BondLaw law, const BondGeometry& geometry) {
    const double smaller = std::min(geometry.sphere_radius_1, geometry.sphere_radius_2);
    const double radius = std::min(geometry.radius, smaller);
    if (law == BondLaw::centre) return cylinder_compliance(radius, geometry.distance);
    const double length = std::max(geometry.length, bond_length_floor * smaller);
    const BondCompliance neck = cylinder_compliance(radius, length);
    if (law == BondLaw::neck) return neck;
    return sum(neck, sum(sphere_compliance(geometry.sphere_radius_1, radius, length / 2.0),
                         sphere_compliance(geometry.sphere_radius_2, radius, length / 2.0)));
}

BondStiffness bond_stiffness(BondLaw law, BondShear shear, double young_modulus, double shear_modulus,
                             const BondGeometry& geometry) {
    if (geometry.radius <= 0.0) return {0.0, 0.0, 0.0, 0.0};
    if (law == BondLaw::solid) return solid_stiffness(young_modulus, shear_modulus, geometry);
    const BondCompliance compliance = bond_compliance(law, geometry);
    double transverse = compliance.stretching / shear_modulus;
    if (shear == BondShear::timoshenko) {
        const double poisson_ratio = young_modulus / (2.0 * shear_modulus) - 1.0;
        const double kappa = 6.0 * (1.0 + poisson_ratio) / (7.0 + 6.0 * poisson_ratio);
        transverse = transverse / kappa + compliance.transverse / young_modulus;
    }
    return {young_modulus / compliance.stretching, 1.0 / transverse, 2.0 * shear_modulus / compliance.bending,
            young_modulus / compliance.bending};
}

std::string name_of(BondLaw law) {
    switch (law) {
        case BondLaw::solid: return "solid";
        case BondLaw::neck: return "neck";
        case BondLaw::centre: return "centre";
        default: return "series";
    }
}

std::string name_of(BondShear shear) { return shear == BondShear::timoshenko ? "timoshenko" : "section"; }

}  // namespace kiln::physics
