// histogram.cpp: counts in bins, and the usual numbers of a distribution.
#include "analysis/histogram.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace kiln::analysis {

Histogram histogram_of(std::span<const double> values, std::size_t bins, double lower) {
    const double upper = values.empty() ? lower : std::ranges::max(values);
    const double width = (upper - lower) / static_cast<double>(bins);
    Histogram histogram{std::vector<double>(bins + 1), std::vector<std::size_t>(bins)};
    for (std::size_t edge = 0; edge <= bins; ++edge) histogram.edges[edge] = lower + static_cast<double>(edge) * width;
    histogram.edges[bins] = upper;  // not a rounding below the largest value
    for (const double value : values)
        ++histogram.counts[width > 0.0 ? std::min(static_cast<std::size_t>((value - lower) / width), bins - 1) : 0];
    return histogram;
}

std::optional<Spread> spread_of(std::span<const double> values) {
    if (values.empty()) return std::nullopt;
    const auto count = static_cast<double>(values.size());
    const double mean = std::accumulate(values.begin(), values.end(), 0.0) / count;
    double squares = 0.0;
    for (const double value : values) squares += (value - mean) * (value - mean);
    const auto [least, most] = std::ranges::minmax(values);
    return Spread{mean, std::sqrt(squares / count), least, most};
}

double quantile_of(std::span<const double> values, std::span<const double> weights, double fraction) {
    constexpr double rounding = 1e-12;  // of a sum
    std::vector<std::size_t> order(values.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, [&](std::size_t row) { return values[row]; });
    const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
    double passed = 0.0;
    for (const std::size_t row : order) {
        passed += weights[row];
        if (passed >= fraction * total * (1.0 - rounding)) return values[row];
    }
    return values[order.back()];
}

}  // namespace kiln::analysis
