// necks.h: the necks of sintered particles as bonds, with one factor on all of them that makes solid and mass agree.
#pragma once

#include <vector>

#include "core/state.h"
#include "core/stop.h"
#include "physics/recorded_necks.h"

namespace kiln::bonding {

/// What decides on the size of necks.
enum class Necks {
    mass,  // one factor on all: the union of spheres and necks has the volume of the mass
    law,   // the sintering law alone, factor 1
};

/// No factor above this is tried: necks of four times the section that the sintering law gives them.
inline constexpr double max_neck_factor = 2.0;

struct NeckSizes {
    std::vector<double> radius;    // m, of each pair
    double factor = 1.0;           // on the necks of the sintering law, before the dihedral limit
    std::size_t limited = 0;       // necks at the dihedral limit, or at the radius of their smaller sphere
    double union_volume = 0.0;     // m3, of spheres and necks
    double union_error = 0.0;      // m3, standard error of that
    bool fills = true;             // false: max_neck_factor leaves the union short of the mass
};

/// Neck of each contact, factor times that of the state's record or sqrt(4 R* h), at most sin(psi/2) min(R1, R2) where a material
/// has the dihedral angle psi, and of two angles the one that allows less, or what the record says where that is more. The factor
/// of Necks::mass is found to 1e-5 of the solid volume; the error of that volume comes to it. Throws Interrupted.
NeckSizes neck_sizes(const State& state, const physics::RecordedContacts& contacts, Necks necks, const Watch& watch = {});

}  // namespace kiln::bonding
