// line_fit.h: the least squares line through points.
#pragma once

#include <limits>
#include <span>

namespace kiln::analysis {

struct Line {
    double intercept = 0.0;
    double slope = 0.0;
    double slope_error = std::numeric_limits<double>::quiet_NaN();  // standard error; NaN for two points
    double r_squared = 1.0;  // share of the squared deviations of y from its mean that the line explains
};

/// y = intercept + slope x by least squares, all points alike. At least two points with different x.
Line fit_line(std::span<const double> x, std::span<const double> y);

}  // namespace kiln::analysis
