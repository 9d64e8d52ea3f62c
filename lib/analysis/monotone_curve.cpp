// monotone_curve.cpp: slopes of the monotone cubic, and its value between two points.
#include "analysis/monotone_curve.h"

#include <algorithm>
#include <cmath>

namespace kiln::analysis {

MonotoneCurve::MonotoneCurve(const std::vector<double>& x, const std::vector<double>& y) {
    for (std::size_t point = 0; point < x.size(); ++point) {
        if (!x_.empty() && x[point] <= x_.back()) {
            y_.back() = y[point];
            continue;
        }
        x_.push_back(x[point]);
        y_.push_back(y[point]);
    }
    std::vector<double> chord;
    for (std::size_t span = 0; span + 1 < x_.size(); ++span) chord.push_back((y_[span + 1] - y_[span]) / (x_[span + 1] - x_[span]));
    slope_.assign(x_.size(), 0.0);
    if (chord.empty()) return;
    slope_.front() = chord.front();
    slope_.back() = chord.back();
    for (std::size_t point = 1; point + 1 < x_.size(); ++point) {
        const double before = chord[point - 1], after = chord[point];
        if (!(before * after > 0.0)) continue;  // a peak, or level on one side
        const double left = x_[point] - x_[point - 1], right = x_[point + 1] - x_[point];
        // The harmonic mean, the nearer chord having more weight.
        slope_[point] = 3.0 * (left + right) / ((2.0 * right + left) / before + (right + 2.0 * left) / after);
    }
}

double MonotoneCurve::at(double x) const {
    if (std::isnan(x)) return x;
    if (x <= x_.front()) return y_.front();
    if (x >= x_.back()) return y_.back();
    const auto after = static_cast<std::size_t>(std::ranges::upper_bound(x_, x) - x_.begin());
    const double length = x_[after] - x_[after - 1], t = (x - x_[after - 1]) / length, u = 1.0 - t;
    return u * u * (1.0 + 2.0 * t) * y_[after - 1] + t * t * (1.0 + 2.0 * u) * y_[after] +
           length * t * u * (u * slope_[after - 1] - t * slope_[after]);
}

}  // namespace kiln::analysis
