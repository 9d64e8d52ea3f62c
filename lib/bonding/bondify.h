// bondify.h: a state of overlapping particles becomes a state of bonded particles.
#pragma once

#include <cstdint>

#include "bonding/shrink.h"
#include "core/state.h"
#include "core/stop.h"
#include "physics/bond_geometry.h"

namespace kiln::bonding {

enum class Method { exact, sweep };

struct Options {
    Method method = Method::exact;
    double decrement = 1e-13;  // m, of a sweep
    Sharing sharing = Sharing::pair;
    physics::BondVolume volume = physics::BondVolume::cylinder;
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
    double lost_volume = 0.0;        // m3, left over in those
    std::size_t thin = 0;            // bonds below the thin ratio, kept or not
    double dropped_volume = 0.0;     // m3, of thin bonds left out
    std::size_t stopped = 0;         // particles that came down to smallest_share of their radius
    double volume_error = 0.0;       // solid volume after, dropped bonds included, over before, minus one
};

/// Shrinks the particles of the state and fills its bonds in the order of find_pairs, replacing those it had.
/// Throws Error naming both ids where centres lie closer than 2 % of the sum of the radii. Where it throws, Interrupted too, the
/// state is as it was.
Summary bondify(State& state, const Options& options, const Watch& watch = {});

}  // namespace kiln::bonding
