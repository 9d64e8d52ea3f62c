// density_curve.cpp: where curves of density pass a density, and which densities they share.
#include "analysis/density_curve.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace kiln::analysis {

namespace {

constexpr double nearby = 0.03;  // relative density
constexpr std::size_t fewest = 4;  // points of a cubic
constexpr double end_fraction = 0.05;
constexpr int max_iterations = 50;

/// The rows between which the curve first passes a density: the row after it.
std::optional<std::size_t> row_after(const std::vector<double>& density, double required) {
    for (std::size_t row = 1; row < density.size(); ++row)
        if (density[row - 1] <= required && density[row] > required) return row;
    return std::nullopt;
}

/// First and last row (behind it) of the points near a density on both sides of the row after it.
std::pair<std::size_t, std::size_t> rows_nearby(const std::vector<double>& density, std::size_t after, double required) {
    std::size_t first = after, last = after;
    const auto is_near = [&](std::size_t row) { return std::abs(density[row] - required) <= nearby; };
    while (first > 0 && is_near(first - 1)) --first;
    while (last < density.size() && is_near(last)) ++last;
    while (last - first < fewest) {  // take the nearer one of the points beside
        const bool below = first > 0, above = last < density.size();
        if (below && (!above || required - density[first - 1] <= density[last] - required))
            --first;
        else
            ++last;
    }
    return {first, last};
}

}  // namespace

std::optional<Crossing> crossing(const DensityCurve& curve, double density) {
    const auto after = curve.size() < fewest ? std::nullopt : row_after(curve.density, density);
    if (!after) return std::nullopt;
    const auto [first, last] = rows_nearby(curve.density, *after, density);
    const double origin = 0.5 * (curve.time[*after - 1] + curve.time[*after]), unit = curve.time[last - 1] - curve.time[first];
    if (!(unit > 0.0)) return std::nullopt;
    Eigen::MatrixXd powers(last - first, fewest);
    Eigen::VectorXd values(last - first);
    for (std::size_t row = first; row < last; ++row) {
        const auto line = static_cast<Eigen::Index>(row - first);
        const double x = (curve.time[row] - origin) / unit;
        powers.row(line) << 1.0, x, x * x, x * x * x;
        values[line] = curve.density[row] - density;
    }
    const Eigen::Vector4d cubic = powers.colPivHouseholderQr().solve(values);
    double x = 0.0;
    for (int iteration = 0; iteration < max_iterations; ++iteration) {
        const double value = cubic[0] + x * (cubic[1] + x * (cubic[2] + x * cubic[3]));
        const double slope = cubic[1] + x * (2.0 * cubic[2] + 3.0 * x * cubic[3]);
        if (!(slope > 0.0)) return std::nullopt;
        const double step = value / slope;
        x -= step;
        if (std::abs(step) < 1e-12) break;
    }
    const double time = origin + unit * x, slope = cubic[1] + x * (2.0 * cubic[2] + 3.0 * x * cubic[3]);
    if (!(slope > 0.0) || !(time >= curve.time[first] && time <= curve.time[last - 1])) return std::nullopt;
    return Crossing{time, curve.schedule.temperature(time), slope / unit};
}

std::vector<double> common_densities(const std::vector<DensityCurve>& curves, std::size_t count) {
    double low = 0.0, high = 1.0;
    for (const DensityCurve& curve : curves) {
        low = std::max(low, curve.density.front());
        high = std::min(high, std::ranges::max(curve.density));
    }
    std::vector<double> densities;
    if (!(high > low)) return densities;
    const double begin = low + end_fraction * (high - low), end = high - end_fraction * (high - low);
    for (std::size_t point = 0; point < count; ++point)
        densities.push_back(begin + (end - begin) * static_cast<double>(point) / static_cast<double>(count - 1));
    return densities;
}

}  // namespace kiln::analysis
