// bond_geometry_test.cpp: length, volume and radius of a bond against closed forms and their own inverse.
#include <doctest/doctest.h>

#include <cmath>
#include <initializer_list>
#include <numbers>

#include "physics/bond_geometry.h"
#include "tests/physics/relative.h"

using namespace kiln::physics;
using kiln::test::relative;
using std::numbers::pi;

TEST_CASE("bond length is Eq. 4 of the paper") {
    const double expected = 90e-9 - std::sqrt(40e-9 * 40e-9 - 20e-9 * 20e-9) - std::sqrt(45e-9 * 45e-9 - 20e-9 * 20e-9);
    CHECK(bond_length(90e-9, 40e-9, 45e-9, 20e-9) == relative(expected, 1e-13));
    CHECK(bond_length(90e-9, 40e-9, 45e-9, 0.0) == relative(5e-9, 1e-13));
}

TEST_CASE("a bond as thick as touching equal spheres reaches from centre to centre") {
    CHECK(bond_length(2.0, 1.0, 1.0, 1.0) == relative(2.0, 1e-14));
    CHECK(bond_volume(2.0, 1.0, 1.0, 1.0, BondVolume::cylinder) == relative(2.0 * pi, 1e-14));
    CHECK(bond_volume(2.0, 1.0, 1.0, 1.0, BondVolume::cap_corrected) == relative(2.0 * pi - 4.0 / 3.0 * pi, 1e-14));
}

TEST_CASE("bond length keeps its digits for a thin bond between touching spheres") {
    const double thin = 1e-6;
    CHECK(bond_length(2.0, 1.0, 1.0, thin) == relative(thin * thin, 1e-12));
}

TEST_CASE("the cap of a great circle is half a sphere, and a low cap is pi R c^2") {
    CHECK(cap_volume(3.0, 3.0) == relative(2.0 / 3.0 * pi * 27.0, 1e-14));
    const double circle = 1e-3, height = circle * circle / 2.0;
    CHECK(cap_volume(1.0, circle) == relative(pi * height * height, 1e-5));
}

TEST_CASE("bond radius inverts bond volume, for both meanings of volume, gaps and sizes") {
    for (const BondVolume kind : {BondVolume::cylinder, BondVolume::cap_corrected})
        for (const double scale : {1e-9, 1.0})
            for (const double gap : {0.0, 1e-6, 0.1, 2.0})
                for (const double radius2 : {1.0, 1.7, 100.0})
                    for (const double wanted : {1e-4, 0.01, 0.3, 0.9, 0.999, 0.999999}) {
                        const double radius1 = scale, other = radius2 * scale, distance = radius1 + other + gap * scale;
                        const double volume = bond_volume(distance, radius1, other, wanted * scale, kind);
                        const double found = bond_radius(volume, distance, radius1, other, kind);
                        // The gap is known to rounding of the distance only: that much of a thin bond's volume is unknown.
                        const double unknown = 1e-15 * radius2 / (wanted * wanted + gap);
                        CHECK(found / scale == relative(wanted, 1e-12 + unknown));
                    }
}

TEST_CASE("a volume without room gives the smaller radius, no volume gives no radius") {
    const double room = bond_volume(2.2, 1.0, 1.1, 1.0, BondVolume::cylinder);
    CHECK(bond_radius(room * 1.01, 2.2, 1.0, 1.1, BondVolume::cylinder) == 1.0);
    CHECK(bond_radius(room * 0.99, 2.2, 1.0, 1.1, BondVolume::cylinder) < 1.0);
    CHECK(bond_radius(0.0, 2.2, 1.0, 1.1, BondVolume::cylinder) == 0.0);
}

TEST_CASE("without the caps the same volume makes a thicker bond") {
    const double volume = 0.1;
    CHECK(bond_radius(volume, 2.1, 1.0, 1.0, BondVolume::cap_corrected) > bond_radius(volume, 2.1, 1.0, 1.0, BondVolume::cylinder));
}
