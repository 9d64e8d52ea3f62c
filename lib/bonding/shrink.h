// shrink.h: overlapping spheres shrink until none overlap, and what they lose goes to the bonds between them.
//
// Dosta et al. 2017, Eq. 2-3: in every sweep each overlapping pair takes dR from both its particles and gains the volume they lost.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace kiln::bonding {

/// Two overlapping particles (rows; equal for a particle and its own image) and the distance of their centres, m.
struct Overlap {
    std::int32_t first, second;
    double distance;
};

/// How fast a particle with k overlaps shrinks. Either way the volume it loses is shared equally among them.
enum class Sharing {
    pair,      // k dR a sweep: every pair takes its own dR, as Eq. 2 stands
    particle,  // dR a sweep, however many pairs it has
};

/// A particle stops shrinking at this share of its radius; its partners then give alone.
inline constexpr double min_share = 0.01;

struct ShrunkSpheres {
    std::vector<double> radius;  // m, of every particle
    std::vector<double> volume;  // m3, given to every overlap
    std::size_t stopped = 0;     // particles that came down to min_share
};

}  // namespace kiln::bonding
