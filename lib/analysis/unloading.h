// unloading.h: the part of a bending test's curve from which the stiffness is read.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/line_fit.h"

namespace kiln::analysis {

/// Points first to last of a curve, both included.
struct Branch {
    std::size_t first, last;
};

/// The last stretch of the test in which the travel of the punch (m) goes back by more than 2 % of its whole way, from its highest
/// to its lowest point; nothing if it never does.
std::optional<Branch> last_unloading(std::span<const double> travel);

/// The last stretch in which it goes forth by as much, from its lowest point to that of the largest force (N) in it.
std::optional<Branch> last_loading(std::span<const double> travel, std::span<const double> force);

/// The last point before the bar breaks: the force (N) falls from it to less than half, while the travel (m) goes back by less
/// than a tenth of the way in which the force had risen from half to all. Only of forces above half the largest of the test: what
/// rattles at small ones does not break. Nothing if the bar holds.
std::optional<std::size_t> point_before_break(std::span<const double> travel, std::span<const double> force);

/// Share of the peak force between which the slope is taken.
struct Window {
    double upper = 5.0 / 6.0;
    double lower = 1.0 / 3.0;
};

/// Window from text such as "5/6:1/3" or "0.8:0.2". Throws TextError unless 1 >= upper > lower >= 0.
Window parse_window(const std::string& text);

/// Points of the branch with a force (N) in the window of the branch's largest force, ends included but for rounding.
std::vector<std::size_t> points_in(std::span<const double> force, const Branch& branch, const Window& window);

/// Why a line of force (N) against deflection (m) does not fit its points; nothing if it does. The force must grow, the line
/// explain 95 % of the squared deviations of the forces from their mean, and of six points or more the slopes of the first and the
/// last half may not differ by a factor of 1.5, but for their errors.
std::optional<std::string> misfit(const Line& line, std::span<const double> deflection, std::span<const double> force);

}  // namespace kiln::analysis
