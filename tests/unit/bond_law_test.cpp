// bond_law_test.cpp: bond stiffness against hand formulas, numerical integration and the limits of thin, thick and short bonds.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "physics/bond_law.h"
#include "physics/bond_stress.h"
#include "physics/hertz.h"
#include "tests/physics/relative.h"

using namespace kiln::physics;
using kiln::test::relative;
using std::numbers::pi;

namespace {

constexpr double E_bond = 400e9, G_bond = 160e9;
constexpr BondGeometry bond{50e-9, 40e-9, 92e-9, 25e-9, 17e-9};
constexpr BondLaw laws[] = {BondLaw::series, BondLaw::neck, BondLaw::centre};
constexpr BondShear shears[] = {BondShear::section, BondShear::timoshenko};

/// Simpson's rule over [0, s] of f.
template <typename Function>
double integral(double s, const Function& f) {
    constexpr int steps = 2000;
    double sum = f(0.0) + f(s);
    for (int k = 1; k < steps; ++k) sum += (k % 2 == 1 ? 4.0 : 2.0) * f(s * k / steps);
    return sum * s / steps / 3.0;
}

void check_equal(const BondStiffness& a, const BondStiffness& b, double tolerance) {
    CHECK(a.normal == relative(b.normal, tolerance));
    CHECK(a.shear == relative(b.shear, tolerance));
    CHECK(a.torsion == relative(b.torsion, tolerance));
    CHECK(a.bending == relative(b.bending, tolerance));
}

}  // namespace

TEST_CASE("neck and centre are E A/L, G A/L, G J/L and E I/L of their lengths") {
    const double A = pi * 25e-9 * 25e-9, I = A * 25e-9 * 25e-9 / 4.0;
    for (const auto& [law, L] : {std::pair{BondLaw::neck, 17e-9}, std::pair{BondLaw::centre, 92e-9}}) {
        const BondStiffness k = bond_stiffness(law, BondShear::section, E_bond, G_bond, bond);
        check_equal(k, {E_bond * A / L, G_bond * A / L, 2.0 * G_bond * I / L, E_bond * I / L}, 1e-13);
    }
}

TEST_CASE("compliance of a truncated sphere is the integral over its sections") {
    const double R = 50e-9, Rb = 21e-9, arm = 8e-9, s = std::sqrt(R * R - Rb * Rb);
    const auto area = [&](double t) { return pi * (R * R - t * t); };
    const auto inertia = [&](double t) { return area(t) * (R * R - t * t) / 4.0; };
    const BondCompliance sphere = sphere_compliance(R, Rb, arm);
    CHECK(sphere.stretching == relative(integral(s, [&](double t) { return 1.0 / area(t); }), 1e-9));
    CHECK(sphere.bending == relative(integral(s, [&](double t) { return 1.0 / inertia(t); }), 1e-9));
    const auto lever = [&](double t) { return s + arm - t; };
    CHECK(sphere.transverse == relative(integral(s, [&](double t) { return lever(t) * lever(t) / inertia(t); }), 1e-9));
}

TEST_CASE("series is the neck and both spheres one after the other") {
    const BondStiffness k = bond_stiffness(BondLaw::series, BondShear::section, E_bond, G_bond, bond);
    double f_n = 17e-9 / (pi * 25e-9 * 25e-9), f_b = 4.0 * f_n / (25e-9 * 25e-9);
    for (const double R : {50e-9, 40e-9}) {
        const double s = std::sqrt(R * R - 25e-9 * 25e-9);
        f_n += std::atanh(s / R) / (pi * R);
        f_b += 4.0 / pi * (s / (2.0 * R * R * (R * R - s * s)) + std::atanh(s / R) / (2.0 * R * R * R));
    }
    check_equal(k, {E_bond / f_n, G_bond / f_n, 2.0 * G_bond / f_b, E_bond / f_b}, 1e-12);
}

TEST_CASE("a bond as thick as its spheres leaves nothing of them, and thicker ones count as that") {
    for (const BondShear shear : shears) {
        const BondGeometry full{40e-9, 40e-9, 90e-9, 40e-9, 90e-9}, thicker{40e-9, 40e-9, 90e-9, 47e-9, 90e-9};
        for (const BondLaw law : laws) {
            check_equal(bond_stiffness(law, shear, E_bond, G_bond, full),
                        bond_stiffness(BondLaw::centre, shear, E_bond, G_bond, full), 1e-12);
            check_equal(bond_stiffness(law, shear, E_bond, G_bond, thicker), bond_stiffness(law, shear, E_bond, G_bond, full),
                        1e-12);
        }
    }
}

TEST_CASE("thin bonds: stiffness falls to zero, as a cylinder's where the bond has a length") {
    for (const BondLaw law : laws) {
        for (const BondShear shear : shears) {
            const BondStiffness none = bond_stiffness(law, shear, E_bond, G_bond, {40e-9, 40e-9, 90e-9, 0.0, 10e-9});
            CHECK(none.normal + none.shear + none.torsion + none.bending == 0.0);
            const BondStiffness thin = bond_stiffness(law, shear, E_bond, G_bond, {40e-9, 40e-9, 90e-9, 40e-15, 10e-9});
            const BondStiffness thinner = bond_stiffness(law, shear, E_bond, G_bond, {40e-9, 40e-9, 90e-9, 4e-15, 10e-9});
            CHECK(thin.normal / thinner.normal == relative(100.0, 1e-3));
            CHECK(thin.bending / thinner.bending == relative(1e4, 1e-3));
            CHECK(thin.torsion / thinner.torsion == relative(1e4, 1e-3));
            // The section shears as its area, the beam bends as the square of that.
            CHECK(thin.shear / thinner.shear == relative(shear == BondShear::section ? 100.0 : 1e4, 1e-3));
        }
    }
}

TEST_CASE("a bond without length counts as a thousandth of the smaller radius long") {
    const BondGeometry none{40e-9, 50e-9, 70e-9, 30e-9, 0.0}, least{40e-9, 50e-9, 70e-9, 30e-9, 40e-12};
    for (const BondShear shear : shears) {
        for (const BondLaw law : {BondLaw::series, BondLaw::neck}) {
            const BondStiffness k = bond_stiffness(law, shear, E_bond, G_bond, none);
            CHECK(std::isfinite(k.normal));
            CHECK(k.shear > 0.0);
            check_equal(k, bond_stiffness(law, shear, E_bond, G_bond, least), 1e-12);
        }
        const BondStiffness k = bond_stiffness(BondLaw::centre, shear, E_bond, G_bond, none);  // does not ask for the length
        check_equal(k, bond_stiffness(BondLaw::centre, shear, E_bond, G_bond, {40e-9, 50e-9, 70e-9, 30e-9, 60e-9}), 1e-12);
    }
}

TEST_CASE("lengths times lambda: translational springs grow by lambda, rotational ones by its cube") {
    const double lambda = 1e7;
    const BondGeometry large{bond.sphere_radius_1 * lambda, bond.sphere_radius_2 * lambda, bond.distance * lambda,
                             bond.radius * lambda, bond.length * lambda};
    for (const BondLaw law : laws) {
        for (const BondShear shear : shears) {
            const BondStiffness k = bond_stiffness(law, shear, E_bond, G_bond, bond);
            const double cube = lambda * lambda * lambda;
            check_equal(bond_stiffness(law, shear, E_bond, G_bond, large),
                        {k.normal * lambda, k.shear * lambda, k.torsion * cube, k.bending * cube}, 1e-12);
        }
    }
}

TEST_CASE("Timoshenko's beam: 12 E I/L3 for a slender cylinder, Cowper's shear for a short one") {
    const double L = 1e-6, r = 1e-9, A = pi * r * r, I = A * r * r / 4.0;
    const BondStiffness slender = bond_stiffness(BondLaw::centre, BondShear::timoshenko, E_bond, G_bond, {1e-6, 1e-6, L, r, L});
    CHECK(slender.shear == relative(12.0 * E_bond * I / (L * L * L), 1e-5));
    const double nu = E_bond / (2.0 * G_bond) - 1.0, kappa = 6.0 * (1.0 + nu) / (7.0 + 6.0 * nu);
    const BondStiffness stout =
        bond_stiffness(BondLaw::centre, BondShear::timoshenko, E_bond, G_bond, {1e-6, 1e-6, 1e-9, 1e-6, 1e-9});
    CHECK(stout.shear == relative(kappa * G_bond * pi * 1e-12 / 1e-9, 1e-5));
}

TEST_CASE("bond stress is force over section plus moment over section modulus, and pressed sections have none of their own") {
    const double r = 2e-9, A = pi * r * r, I = A * r * r / 4.0;
    const BondStress stress = bond_stress(3e-6, 2e-6, 5e-15, 7e-15, r);
    CHECK(stress.tensile == relative(3e-6 / A + 5e-15 * r / I, 1e-14));
    CHECK(stress.shear == relative(2e-6 / A + 7e-15 * r / (2.0 * I), 1e-14));
    CHECK(bond_stress(-3e-6, 0.0, 0.0, 0.0, r).tensile == relative(-3e-6 / A, 1e-14));
    const BondStress doubled = bond_stress(0.0, 0.0, 1e-15, 0.0, 2.0 * r);
    CHECK(doubled.tensile == relative(bond_stress(0.0, 0.0, 1e-15, 0.0, r).tensile / 8.0, 1e-14));
}

TEST_CASE("Hertz contact with a wall: force is the slope of the energy, stiffness that of the force, none without overlap") {
    const double modulus = contact_modulus(E_bond, 0.25), R = 50e-9, h = 1e-9, step = 1e-13;
    CHECK(modulus == relative(E_bond / 0.9375, 1e-14));
    const HertzContact here = hertz_contact(modulus, R, h);
    const HertzContact less = hertz_contact(modulus, R, h - step), more = hertz_contact(modulus, R, h + step);
    CHECK(here.force == relative(4.0 / 3.0 * modulus * std::sqrt(R) * std::pow(h, 1.5), 1e-14));
    CHECK(here.force == relative((more.energy - less.energy) / (2.0 * step), 1e-6));
    CHECK(here.stiffness == relative((more.force - less.force) / (2.0 * step), 1e-6));
    CHECK(hertz_contact(modulus, R, -h).force == 0.0);
    CHECK(hertz_contact(modulus, R, 0.0).stiffness == 0.0);
}
