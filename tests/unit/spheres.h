// spheres.h: states of spheres that tests of bonding share.
#pragma once

#include <numeric>
#include <vector>

#include "core/state.h"

namespace kiln::test {

/// Spheres of one material without constants in a cubic box of the given edge, m.
inline State make_state(const std::vector<Vec3>& position, const std::vector<double>& radius, double edge, bool periodic) {
    State state;
    state.materials.emplace_back();
    state.box.lengths = Vec3::Constant(edge);
    state.box.periodic = {periodic, periodic, periodic};
    state.particles.position = position;
    state.particles.radius = radius;
    state.particles.id.resize(radius.size());
    std::iota(state.particles.id.begin(), state.particles.id.end(), 0);
    state.particles.material.assign(radius.size(), 0);
    return state;
}

}  // namespace kiln::test
