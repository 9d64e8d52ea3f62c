// unloading.cpp: the part of a bending test's curve from which the stiffness is read.
#include "analysis/unloading.h"

#include <algorithm>
#include <charconv>

#include "core/types.h"

namespace kiln::analysis {

namespace {

constexpr double rounding = 1e-9;      // of the peak force, by which a point may miss the window
constexpr double min_return = 0.02;  // of the whole travel, by which the punch must go back; less is tremor of the reading

std::optional<double> number_of(std::string_view text) {
    double number = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return number;
}

/// "5/6" or "0.83".
std::optional<double> fraction_of(std::string_view text) {
    const std::size_t bar = text.find('/');
    const auto numerator = number_of(text.substr(0, bar));
    if (bar == std::string_view::npos || !numerator) return numerator;
    const auto denominator = number_of(text.substr(bar + 1));
    if (!denominator || *denominator == 0.0) return std::nullopt;
    return *numerator / *denominator;
}

}  // namespace

std::optional<Branch> last_unloading(std::span<const double> travel) {
    if (travel.size() < 2) return std::nullopt;
    const auto [least, most] = std::ranges::minmax(travel);
    const double tremor = min_return * (most - least);
    std::optional<Branch> found;
    std::size_t top = 0, bottom = 0;  // of the stretch that is being walked, as far as it goes
    bool down = false;
    for (std::size_t point = 1; point < travel.size(); ++point) {
        if (travel[point] > travel[top]) top = point;
        if (travel[point] < travel[bottom]) bottom = point;
        const bool turns_down = !down && travel[point] < travel[top] - tremor;
        const bool turns_up = down && travel[point] > travel[bottom] + tremor;
        if (turns_up) top = point;
        if (turns_down) bottom = point;
        if (turns_up || turns_down) down = !down;
        if (turns_down) found = Branch{top, bottom};
        if (down) found->last = bottom;
    }
    return found;
}

Window parse_window(const std::string& text) {
    const std::size_t colon = text.find(':');
    const auto upper = fraction_of(std::string_view(text).substr(0, colon));
    const auto lower = colon == std::string::npos ? std::nullopt : fraction_of(std::string_view(text).substr(colon + 1));
    if (!upper || !lower || !(*upper <= 1.0 && *upper > *lower && *lower >= 0.0))
        throw TextError("is '" + text + "', expected UPPER:LOWER with 1 >= UPPER > LOWER >= 0, such as 5/6:1/3");
    return {*upper, *lower};
}

std::vector<std::size_t> points_in(std::span<const double> force, const Branch& branch, const Window& window) {
    const double peak = std::ranges::max(force.subspan(branch.first, branch.last - branch.first + 1));
    std::vector<std::size_t> points;
    for (std::size_t point = branch.first; point <= branch.last; ++point)
        if (force[point] >= (window.lower - rounding) * peak && force[point] <= (window.upper + rounding) * peak)
            points.push_back(point);
    return points;
}

}  // namespace kiln::analysis
