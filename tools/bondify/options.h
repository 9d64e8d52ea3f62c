// options.h: what the user can choose about the transition to the bonded-particle model.
#pragma once

#include "tools/bondify/shrink.h"
#include "physics/bond_geometry.h"

namespace CLI {
class App;
}

namespace kiln::bondify {

enum class Method { exact, sweep };

struct Options {
    Method method = Method::exact;
    double decrement = 1e-13;  // m, of a sweep
    Sharing sharing = Sharing::pair;
    physics::BondVolume volume = physics::BondVolume::cylinder;
    double thin_ratio = 0.01;  // bond radius over the smaller particle's radius, below which a bond is thin
    bool drop_thin = false;

    void add_to(CLI::App& app);
};

}  // namespace kiln::bondify
