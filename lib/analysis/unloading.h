// unloading.h: the part of a bending test's curve from which the stiffness is read.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace kiln::analysis {

/// Points first to last of a curve, both included.
struct Branch {
    std::size_t first, last;
};

/// The last stretch of the test in which the travel of the punch (m) goes back by more than 2 % of its whole way, from its highest
/// to its lowest point; nothing if it never does.
std::optional<Branch> last_unloading(std::span<const double> travel);

/// Share of the peak force between which the slope is taken.
struct Window {
    double upper = 5.0 / 6.0;
    double lower = 1.0 / 3.0;
};

/// Window from text such as "5/6:1/3" or "0.8:0.2". Throws TextError unless 1 >= upper > lower >= 0.
Window parse_window(const std::string& text);

/// Points of the branch with a force (N) in the window of the branch's largest force, ends included but for rounding.
std::vector<std::size_t> points_in(std::span<const double> force, const Branch& branch, const Window& window);

}  // namespace kiln::analysis
