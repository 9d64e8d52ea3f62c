// solid_law_test.cpp: the law solid against punches on half-spaces, cylinders, finite elements of one neck, and in its limits.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "physics/neck.h"
#include "physics/solid_law.h"
#include "tests/physics/relative.h"

using namespace kiln::physics;
using kiln::test::relative;
using std::numbers::pi;

namespace {

constexpr double E = 400e9, nu = 0.23, G = E / (2.0 * (1.0 + nu)), R = 50e-9;

/// Springs of a neck of radius x R between spheres that meet in its circle, as in a chain of truncated spheres.
BondStiffness chain(double x, double coverage = 0.0) {
    return solid_stiffness(E, G, {R, R, 2.0 * R * std::sqrt(1.0 - x * x), x * R, 0.0, coverage, coverage});
}

std::vector<double> springs(const BondStiffness& k) { return {k.normal, k.shear, k.torsion, k.bending}; }

}  // namespace

TEST_CASE("solid: early necks are two rigid punches on half-spaces, in all four springs") {
    const double a = 1e-4 * R, length = a * a / (2.0 * R);  // Coble's
    const BondStiffness k = solid_stiffness(E, G, {R, R, 2.0 * R - length, a, length});
    CHECK(k.normal == relative(E * a / (1.0 - nu * nu), 2e-3));
    CHECK(k.shear == relative(2.0 * E * a / ((2.0 - nu) * (1.0 + nu)), 2e-3));
    CHECK(k.torsion == relative(4.0 * E * a * a * a / (3.0 * (1.0 + nu)), 2e-3));
    CHECK(k.bending == relative(2.0 * E * a * a * a / (3.0 * (1.0 - nu * nu)), 2e-3));
}

TEST_CASE("solid: a neck as wide as its spheres is 0.7 of a cylinder, and a wider one counts as that") {
    const double L = 0.4 * R, A = pi * R * R, I = A * R * R / 4.0;
    for (const double radius : {R, 1.3 * R}) {
        const BondStiffness k = solid_stiffness(E, G, {R, R, L, radius, L, 1.0, 1.0});
        CHECK(k.normal == relative(E * A / (0.7 * L), 1e-12));
        CHECK(k.shear == relative(1.0 / (0.7 * (L / (G * A) + L * L * L / (12.0 * E * I))), 1e-12));
        CHECK(k.torsion == relative(2.0 * G * I / (0.7 * L), 1e-12));
        CHECK(k.bending == relative(E * I / (0.7 * L), 1e-12));
    }
}

TEST_CASE("solid: half-way it is the sum of its parts, with sections integrated one by one") {
    const double R1 = 50e-9, R2 = 80e-9, a = 30e-9, L = 7e-9, A = pi * a * a, I = A * a * a / 4.0, O1 = 0.7, O2 = 5.0;
    double normal = 0.7 * L / (E * A), shear = 0.7 * (L / (G * A) + L * L * L / (12.0 * E * I));
    double torsion = 0.7 * L / (2.0 * G * I), bending = 0.7 * L / (E * I);
    for (const auto& [R_i, W] : {std::pair{R1, 1.0}, std::pair{R2, std::pow(O2, 0.35)}}) {
        const double s = std::sqrt(R_i * R_i - a * a), open = 1.0 - a / R_i;
        const int steps = 200000;
        double stretch = 0.0, bend = 0.0, transverse = 0.0;
        for (int k = 0; k < steps; ++k) {
            const double t = s * (k + 0.5) / steps, area = pi * (R_i * R_i - t * t), inertia = area * area / (4.0 * pi);
            const double lever = s + L / 2.0 - t;
            stretch += s / steps / area;
            bend += s / steps / inertia;
            transverse += s / steps * lever * lever / inertia;
        }
        normal += (1.0 - nu * nu) / (2.0 * E * a) * std::pow(open, 2.25) + 0.6 * W * stretch / E;
        shear += (2.0 - nu) * (1.0 + nu) / (4.0 * E * a) * std::pow(open, 2.25) + W * (stretch / G + transverse / E);
        torsion += 3.0 * (1.0 + nu) / (8.0 * E * a * a * a) * std::pow(open, 1.25) + 0.6 * W * bend / (2.0 * G);
        bending += 3.0 * (1.0 - nu * nu) / (4.0 * E * a * a * a) * std::pow(open, 1.25) + 0.6 * W * bend / E;
    }
    const BondStiffness k = solid_stiffness(E, G, {R1, R2, 110e-9, a, L, O1, O2});
    CHECK(k.normal == relative(1.0 / normal, 1e-9));
    CHECK(k.shear == relative(1.0 / shear, 1e-9));
    CHECK(k.torsion == relative(1.0 / torsion, 1e-9));
    CHECK(k.bending == relative(1.0 / bending, 1e-9));
}

TEST_CASE("solid: stiffer than finite elements of a chain of truncated spheres, by no more than what it leaves of their sections") {
    for (const double x : {0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8}) {
        const double f = (1.0 + x * (0.554 + x * (0.265 - 0.294 * x))) / std::sqrt(1.0 - x * x);
        const double ratio = chain(x).normal / (E * x * R * f / (1.0 - nu * nu));
        CHECK(ratio > 1.0);
        CHECK(ratio < 1.0 / 0.6);
    }
}

TEST_CASE("solid: finite and positive without length, from thin necks to full ones, for spheres up to a hundred to one") {
    for (const double ratio : {1.0, 3.0, 100.0}) {
        std::vector<double> before(4, 0.0);
        for (const double x : {1e-9, 1e-6, 1e-3, 0.1, 0.5, 0.9, 0.999, 1.0 - 1e-12, 1.0}) {
            const BondGeometry neck{R, ratio * R, (1.0 + ratio) * R, x * R, 0.0, 3.0, 0.2};
            const std::vector<double> found = springs(solid_stiffness(E, G, neck));
            for (std::size_t k = 0; k < found.size(); ++k) {
                CHECK(std::isfinite(found[k]));
                CHECK(found[k] > before[k]);  // and stiffer, the thicker the neck
            }
            before = found;
            const BondGeometry turned{ratio * R, R, (1.0 + ratio) * R, x * R, 0.0, 0.2, 3.0};
            const std::vector<double> same = springs(solid_stiffness(E, G, turned));
            for (std::size_t k = 0; k < found.size(); ++k) CHECK(same[k] == relative(found[k], 1e-12));
        }
    }
}

TEST_CASE("solid: what necks cover beyond the whole surface softens, and nothing less does") {
    const std::vector<double> alone = springs(chain(0.6)), half = springs(chain(0.6, 0.5)), crowded = springs(chain(0.6, 2.0));
    for (std::size_t k = 0; k < alone.size(); ++k) {
        CHECK(half[k] == alone[k]);
        CHECK(crowded[k] < alone[k]);
        CHECK(crowded[k] > alone[k] / std::pow(2.0, 0.35));
    }
    CHECK(cap_share(R, R) == relative(0.5, 1e-15));
    CHECK(cap_share(R, 1.2 * R) == relative(0.5, 1e-15));
    CHECK(cap_share(R, 0.6 * R) == relative(0.1, 1e-12));
    CHECK(cap_share(R, 1e-6 * R) == relative(0.25e-12, 1e-6));
}

TEST_CASE("solid: lengths times lambda") {
    const double lambda = 1e7;
    const BondStiffness k = solid_stiffness(E, G, {R, 2.0 * R, 2.9 * R, 0.6 * R, 0.1 * R, 1.2, 0.4});
    const BondStiffness large = solid_stiffness(
        E, G, {lambda * R, 2.0 * lambda * R, 2.9 * lambda * R, 0.6 * lambda * R, 0.1 * lambda * R, 1.2, 0.4});
    CHECK(large.normal == relative(lambda * k.normal, 1e-12));
    CHECK(large.shear == relative(lambda * k.shear, 1e-12));
    CHECK(large.torsion == relative(lambda * lambda * lambda * k.torsion, 1e-12));
    CHECK(large.bending == relative(lambda * lambda * lambda * k.bending, 1e-12));
}

TEST_CASE("solid stands among the laws, and asks for no way of shear") {
    const BondGeometry neck{R, R, 1.9 * R, 0.5 * R, 0.17 * R, 0.8, 0.8};
    const BondStiffness direct = solid_stiffness(E, G, neck);
    for (const BondShear shear : {BondShear::section, BondShear::timoshenko})
        CHECK(springs(bond_stiffness(BondLaw::solid, shear, E, G, neck)) == springs(direct));
    BondGeometry none = neck;
    none.radius = 0.0;
    CHECK(bond_stiffness(BondLaw::solid, BondShear::section, E, G, none).normal == 0.0);
    CHECK(name_of(BondLaw::solid) == "solid");
}

TEST_CASE("solid: what the solid's own Poisson's ratio adds begins with necks that share bulk, and is all of it in a dense body") {
    CHECK(poisson_shift(0.35, 0.5) == 0.0);
    CHECK(poisson_shift(0.23, 0.8) == 0.0);
    CHECK(poisson_shift(0.35, 0.775) == relative(0.06, 1e-12));
    CHECK(poisson_shift(0.15, 1.0) == relative(-0.08, 1e-12));
    CHECK(poisson_shift(0.15, 1.1) == relative(-0.08, 1e-12));
}
