// histogram.h: how values are spread: counts in bins of equal width, and the usual numbers of a distribution.
#pragma once

#include <span>

#include "core/types.h"

namespace kiln::analysis {

/// {edges, counts} of bins of equal width from `lower` to the largest value, which belongs to the last bin; no value is below
/// `lower`.
Json histogram_of(std::span<const double> values, std::size_t bins, double lower);

/// {mean, standard_deviation (of the values themselves), minimum, maximum}; null without values.
Json spread_of(std::span<const double> values);

}  // namespace kiln::analysis
