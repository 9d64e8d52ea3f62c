// histogram.h: how values are spread: counts in bins of equal width, and the usual numbers of a distribution.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace kiln::analysis {

struct Histogram {
    std::vector<double> edges;        // one more than there are bins
    std::vector<std::size_t> counts;  // of each bin
};

/// Bins of equal width from `lower` to the largest value, which belongs to the last bin; no value is below `lower`.
Histogram histogram_of(std::span<const double> values, std::size_t bins, double lower);

struct Spread {
    double mean, standard_deviation;  // of the values themselves
    double minimum, maximum;
};

/// Nothing without values.
std::optional<Spread> spread_of(std::span<const double> values);

/// The smallest of the values up to which their weights, added in ascending order of the values, make up a fraction of all weights.
/// There is at least one value, with a positive weight.
double quantile_of(std::span<const double> values, std::span<const double> weights, double fraction);

}  // namespace kiln::analysis
