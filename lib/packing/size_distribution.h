// size_distribution.h: particle size distributions: monosize, lognormal, bimodal, percentiles, lists and measured tables.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "packing/file_manner.h"
#include "packing/random.h"
#include "packing/size_classes.h"

namespace kiln::packing {

struct Monosize {
    double diameter;  // m
};

struct Lognormal {
    double median;             // m, by number
    double deviation;          // geometric standard deviation, >= 1
    double smallest, largest;  // m, diameters beyond these are drawn again
};

struct Bimodal {
    double first, second;   // m
    double first_fraction;  // of the number of particles
};

struct DiameterList {
    std::vector<double> diameters;  // m
};

using SizeDistribution = std::variant<Monosize, Lognormal, Bimodal, DiameterList, SizeClasses>;

/// What a text such as "lognormal:100nm:1.4:50nm:200nm" says, of number or volume. diameter: m, for "monosize". weighting: where
/// none is given, number, but volume for percentiles, and what a file says. shares, manner: for file:NAME, see size_table.h.
/// Throws TextError for a text that is none of the known ones, Error for a file that cannot be read.
SizeDistribution parse_distribution(const std::string& text, double diameter, std::optional<Weighting> weighting = {},
                                    std::optional<Shares> shares = {}, const FileManner& manner = {});

/// Radii (m) of the given number of particles. A list gives each of its diameters as often as it can, and what then is left to draw
/// at random, none twice.
std::vector<double> draw_radii(const SizeDistribution& distribution, std::size_t particles, Random& random);

/// The diameter (m) below which a fraction of a distribution lies, by number or by volume.
double size_quantile(const SizeDistribution& distribution, double fraction, Weighting weighting);

}  // namespace kiln::packing
