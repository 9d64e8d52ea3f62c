// solid_law.cpp: punches, sections and the neck, added up.
#include "physics/solid_law.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kiln::physics {

namespace {

using std::numbers::pi;

constexpr double translation_power = 9.0 / 4.0;  // of 1 - x, on punches that shift
constexpr double rotation_power = 5.0 / 4.0;     // on punches that turn
constexpr double cylinder_part = 0.7;           // of the compliance of a neck's cylinder
constexpr double stretching_part = 0.6;          // of that of a sphere's sections, pulled at
constexpr double turning_part = 0.6;             // of the same, turned
constexpr double coverage_power = 0.35;

double square(double value) { return value * value; }

}  // namespace

double cap_share(double sphere_radius, double bond_radius) {
    const double x2 = square(std::min(bond_radius / sphere_radius, 1.0));
    return 0.5 * x2 / (1.0 + std::sqrt(1.0 - x2));
}

double poisson_shift(double poisson_ratio, double solid_fraction) {
    constexpr double met_by_springs = 0.23, first_fraction = 0.55;
    return std::clamp((solid_fraction - first_fraction) / (1.0 - first_fraction), 0.0, 1.0) * (poisson_ratio - met_by_springs);
}

BondStiffness solid_stiffness(double young_modulus, double shear_modulus, const BondGeometry& geometry) {
    const double E = young_modulus, G = shear_modulus, nu = E / (2.0 * G) - 1.0;
    const double smaller = std::min(geometry.sphere_radius_1, geometry.sphere_radius_2);
    const double a = std::min(geometry.radius, smaller);
    const double L = std::max(geometry.length, bond_length_floor * square(a) / smaller);  // early necks are far shorter than wide
    const double A = pi * square(a), I = A * square(a) / 4.0;
    const double C = cylinder_part;
    double normal = C * L / (E * A), shear = C * (L / (G * A) + L * square(L) / (12.0 * E * I));
    double torsion = C * L / (2.0 * G * I), bending = C * L / (E * I);

    const double P_n = (1.0 - nu * nu) / (2.0 * E * a), P_t = (2.0 - nu) * (1.0 + nu) / (4.0 * E * a);
    const double P_q = 3.0 * (1.0 + nu) / (8.0 * E * a * square(a)), P_b = 3.0 * (1.0 - nu * nu) / (4.0 * E * a * square(a));
    const auto add_side = [&](double R, double coverage) {
        const double open = std::max(0.0, 1.0 - a / R);
        const double shifting = std::pow(open, translation_power), turning = std::pow(open, rotation_power);
        const double W = std::pow(std::max(1.0, coverage), coverage_power);
        const BondCompliance sphere = sphere_compliance(R, a, L / 2.0);
        normal += P_n * shifting + stretching_part * W * sphere.stretching / E;
        shear += P_t * shifting + W * (2.0 * (1.0 + nu) * sphere.stretching + sphere.transverse) / E;
        torsion += P_q * turning + turning_part * W * (1.0 + nu) * sphere.bending / E;
        bending += P_b * turning + turning_part * W * sphere.bending / E;
    };
    add_side(geometry.sphere_radius_1, geometry.coverage_1);
    add_side(geometry.sphere_radius_2, geometry.coverage_2);
    return {1.0 / normal, 1.0 / shear, 1.0 / torsion, 1.0 / bending};
}

}  // namespace kiln::physics
