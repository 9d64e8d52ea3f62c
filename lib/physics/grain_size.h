// grain_size.h: what a microscope would say of the sizes of grains, and how much of their surface necks cover.
#pragma once

#include <span>

#include "core/neighbours.h"

namespace kiln::physics {

struct GrainSize {
    std::size_t grains = 0;
    double mean_diameter = 0.0;   // m, mean over the grains
    double mean_intercept = 0.0;  // m, mean length of random lines in the grains as spheres, (4/3) sum r^3/sum r^2
    double scatter = 0.0;         // standard deviation of the diameters over their mean
    double coverage = 0.0;        // share of a grain's surface that is neck, sum a^2/(4 r^2) over its necks, mean over the grains
};

/// radius: m, of each grain. pairs: those that may touch; overlap: of each, m, negative for a gap.
GrainSize grain_size(std::span<const double> radius, std::span<const Pair> pairs, std::span<const double> overlap);

}  // namespace kiln::physics
