// bondify.h: a state of overlapping particles becomes a state of bonded particles.
#pragma once

#include <cstdint>

#include "bonding/necks.h"
#include "bonding/shrink.h"
#include "core/state.h"
#include "core/stop.h"
#include "physics/bond_geometry.h"

namespace kiln::bonding {

enum class Method {
    exact,  // particles shrink until none overlap, bonds take what they lose: the limit of small decrements
    sweep,  // the same by sweeps
    necks,  // particles stay as they are, bonds are the necks of the sintering law
};

struct Options {
    Method method = Method::exact;
    double decrement = 1e-13;  // m, of a sweep
    Sharing sharing = Sharing::pair;
    physics::BondVolume volume = physics::BondVolume::cylinder;
    Necks necks = Necks::mass;
    double thin_ratio = 0.01;  // bond radius over the smaller particle's radius, below which a bond is thin
    bool drop_thin = false;
};

/// What a state's history says about its transition.
struct Summary {
    std::size_t pairs = 0;           // that overlapped
    std::size_t bonds = 0;           // that were made of them
    double mean_diameter = 0.0;      // m
    double mean_length = 0.0;        // m
    double coordination_number = 0;  // bond ends per particle
    std::size_t clamped = 0;         // bonds as thick as the smaller particle, with volume left over
    double bond_volume = 0.0;        // m3, that the particles gave to their bonds
    double lost_volume = 0.0;        // m3, left over in clamped bonds
    std::size_t thin = 0;            // bonds below the thin ratio, kept or not
    double dropped_volume = 0.0;     // m3, of thin bonds left out
    std::size_t stopped = 0;         // particles that came down to min_share of their radius
    double volume_error = 0.0;       // solid volume after, dropped bonds included, over before, minus one

    // Of necks.
    double neck_factor = 1.0;     // on the necks of the sintering law
    std::size_t limited = 0;      // at the dihedral limit
    double solid_fraction = 0.0;  // solid volume of the mass over the volume of the box
    double union_fraction = 0.0;  // the same of the union of spheres and necks
    double union_error = 0.0;     // standard error of that
    bool fills = true;            // false: no factor makes the two agree
};

/// Shrinks the particles of the state and fills its bonds in the order of find_pairs, replacing those it had, and the necks of its
/// record, which the bonds of Method::necks take up. Those have the volume zero, since the particles keep all mass.
/// Throws Error naming both ids where centres lie closer than 2 % of the sum of the radii. Where it throws, Interrupted too, the
/// state is as it was.
Summary bondify(State& state, const Options& options, const Watch& watch = {});

}  // namespace kiln::bonding
