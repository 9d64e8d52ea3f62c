// size_distribution.h: particle size distributions by number: monosize, lognormal, bimodal, a list from a file.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "packing/random.h"

namespace kiln::packing {

struct Monosize {
    double diameter;  // m
};

struct Lognormal {
    double median;             // m
    double deviation;          // geometric standard deviation, >= 1
    double smallest, largest;  // m, diameters beyond these are drawn again
};

struct Bimodal {
    double first, second;   // m
    double first_fraction;  // of the number of particles
};

struct DiameterList {
    std::vector<double> diameters;  // m, taken in turn
};

using SizeDistribution = std::variant<Monosize, Lognormal, Bimodal, DiameterList>;

/// What a text such as "lognormal:100nm:1.4:50nm:200nm" says. diameter: m, for "monosize".
/// Throws TextError for a text that is none of the known ones, Error for a file that cannot be read.
SizeDistribution parse_distribution(const std::string& text, double diameter);

/// Radii (m) of the given number of particles.
std::vector<double> draw_radii(const SizeDistribution& distribution, std::size_t particles, Random& random);

}  // namespace kiln::packing
