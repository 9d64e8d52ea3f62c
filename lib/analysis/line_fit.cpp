// line_fit.cpp: the least squares line through points.
#include "analysis/line_fit.h"

#include <cmath>
#include <numeric>

namespace kiln::analysis {

Line fit_line(std::span<const double> x, std::span<const double> y) {
    const auto count = static_cast<double>(x.size());
    const double mean_x = std::accumulate(x.begin(), x.end(), 0.0) / count;
    const double mean_y = std::accumulate(y.begin(), y.end(), 0.0) / count;
    double xx = 0.0, xy = 0.0, yy = 0.0;
    for (std::size_t point = 0; point < x.size(); ++point) {
        xx += (x[point] - mean_x) * (x[point] - mean_x);
        xy += (x[point] - mean_x) * (y[point] - mean_y);
        yy += (y[point] - mean_y) * (y[point] - mean_y);
    }
    Line line;
    line.slope = xy / xx;
    line.intercept = mean_y - line.slope * mean_x;
    if (x.size() < 3) return line;
    double squares = 0.0;
    for (std::size_t point = 0; point < x.size(); ++point) {
        const double residual = (y[point] - mean_y) - line.slope * (x[point] - mean_x);
        squares += residual * residual;
    }
    line.slope_error = std::sqrt(squares / (count - 2.0) / xx);
    line.r_squared = 1.0 - squares / yy;
    return line;
}

}  // namespace kiln::analysis
