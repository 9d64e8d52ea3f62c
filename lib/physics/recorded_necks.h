// recorded_necks.h: the contacts of a state, with the necks that it lists beside those that overlaps tell.
#pragma once

#include <vector>

#include "core/neighbours.h"
#include "core/state.h"

namespace kiln::physics {

struct RecordedContacts {
    std::vector<Pair> pairs;
    std::vector<double> neck;     // m, of each pair: the recorded radius, or sqrt(4 R* h) where there is none
    std::vector<double> overlap;  // m, the h of that neck
    std::vector<char> recorded;   // whether there is a record
};

/// Pairs of particles whose spheres overlap or whose neck is recorded, less those recorded with no neck at all; sorted as
/// find_pairs does.
RecordedContacts recorded_contacts(const State& state);

}  // namespace kiln::physics
