// unloading.cpp: the part of a bending test's curve from which the stiffness is read.
#include "analysis/unloading.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <ranges>

#include "core/types.h"

namespace kiln::analysis {

namespace {

constexpr double rounding = 1e-9;           // of the peak force, by which a point may miss the window
constexpr double min_elastic_return = 0.1;  // of the way in which the force rose; whole bars go back by about all of it
constexpr double min_explained = 0.95;      // of the squared deviations of forces from their mean
constexpr double max_slope_ratio = 1.5;     // of the two halves of a branch
constexpr double max_errors_apart = 3.0;    // of two slopes that are the same
constexpr double min_return = 0.02;         // of the whole travel, by which the punch must go back; less is tremor of the reading

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

struct Stretch {
    Branch branch;
    bool down;
};

/// The test cut where the travel turns.
std::vector<Stretch> stretches(std::span<const double> travel) {
    std::vector<Stretch> found;
    if (travel.size() < 2) return found;
    const auto [least, most] = std::ranges::minmax(travel);
    const double tremor = min_return * (most - least);
    std::size_t start = 0, top = 0, bottom = 0;  // of the stretch that is being walked, as far as it goes
    bool down = false;
    const auto end_stretch = [&](std::size_t end) {
        if (end > start) found.push_back({{start, end}, down});
        start = end;
    };
    for (std::size_t point = 1; point < travel.size(); ++point) {
        if (travel[point] > travel[top]) top = point;
        if (travel[point] < travel[bottom]) bottom = point;
        if (!down && travel[point] < travel[top] - tremor) {
            end_stretch(top);
            bottom = point;
            down = true;
        } else if (down && travel[point] > travel[bottom] + tremor) {
            end_stretch(bottom);
            top = point;
            down = false;
        }
    }
    end_stretch(down ? bottom : top);
    return found;
}

}  // namespace

std::optional<Branch> last_unloading(std::span<const double> travel) {
    for (const Stretch& stretch : std::views::reverse(stretches(travel)))
        if (stretch.down) return stretch.branch;
    return std::nullopt;
}

std::optional<Branch> last_loading(std::span<const double> travel, std::span<const double> force) {
    for (const Stretch& stretch : std::views::reverse(stretches(travel))) {
        if (stretch.down) continue;
        const auto [first, last] = stretch.branch;
        const auto part = force.subspan(first, last - first + 1);
        return Branch{first, first + static_cast<std::size_t>(std::distance(part.begin(), std::ranges::max_element(part)))};
    }
    return std::nullopt;
}

std::optional<std::size_t> point_before_break(std::span<const double> travel, std::span<const double> force) {
    if (force.empty()) return std::nullopt;
    const double largest = std::ranges::max(force);
    std::size_t top = 0;  // where the force was largest since it last fell to half
    for (std::size_t point = 1; point < force.size(); ++point) {
        if (force[point] >= force[top]) top = point;
        if (force[point] >= 0.5 * force[top]) continue;
        if (force[top] >= 0.5 * largest) {
            std::size_t half = top;
            while (half > 0 && force[half] > 0.5 * force[top]) --half;
            const double risen = std::max(0.0, travel[top] - travel[half]), back = travel[top] - travel[point];
            if (back <= min_elastic_return * risen) return top;
        }
        top = point;
    }
    return std::nullopt;
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

std::optional<std::string> misfit(const Line& line, std::span<const double> deflection, std::span<const double> force) {
    if (!(line.slope > 0.0) || !std::isfinite(line.slope)) return "the force does not grow with the deflection";
    if (line.r_squared < min_explained) {
        char share[32];
        std::snprintf(share, sizeof share, "%.0f", 100.0 * std::max(0.0, line.r_squared));
        return "a straight line explains only " + std::string(share) + " % of how the force varies";
    }
    const std::size_t half = force.size() / 2;
    if (half < 3) return std::nullopt;
    const Line first = fit_line(deflection.first(half), force.first(half)),
               last = fit_line(deflection.last(half), force.last(half));
    const auto [flat, steep] = std::minmax(first.slope, last.slope);
    if (steep > max_slope_ratio * flat && steep - flat > max_errors_apart * std::hypot(first.slope_error, last.slope_error))
        return "the curve bends: the slopes of its halves differ by more than a factor of 1.5";
    return std::nullopt;
}

}  // namespace kiln::analysis
