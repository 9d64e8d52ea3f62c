// value_options.cpp: how numbers and their bounds are written, and choices between words.
#include "tools/common/value_options.h"

#include <algorithm>

namespace kiln::cli {

std::string number_text(double value) {
    char text[32];
    const auto written = std::to_chars(text, text + sizeof text, value);
    std::string number(text, written.ptr);
    const std::size_t exponent = number.find('e');
    if (exponent == std::string::npos) return number;
    std::string power = number.substr(exponent + 1);
    const bool negative = power.front() == '-';
    power.erase(0, power.find_first_not_of("+-0"));
    return number.substr(0, exponent) + (negative ? "e-" : "e") + power;
}

std::string not_within(const Bounds<double>& bounds) {
    const auto [lower, upper] = bounds;
    if (std::isfinite(lower) && std::isfinite(upper))
        return "between " + (lower == above_zero ? "0" : number_text(lower)) + " and " + number_text(upper);
    if (lower == above_zero) return "greater than 0";
    return std::isfinite(lower) ? number_text(lower) + " or more" : "in the range of numbers";
}

std::string known_bounds(const Bounds<double>& bounds) {
    const auto [lower, upper] = bounds;
    if (!std::isfinite(lower)) return "";
    const std::string from = lower == above_zero ? "above 0" : number_text(lower);
    if (std::isfinite(upper)) return " [" + from + (lower == above_zero ? ", up to " : " to ") + number_text(upper) + "]";
    return " [" + from + (lower == above_zero ? "]" : " or more]");
}

std::size_t choice_from(const std::string& option, const std::string& text, const std::vector<std::string>& words) {
    const auto found = std::ranges::find(words, text);
    if (found != words.end()) return static_cast<std::size_t>(found - words.begin());
    std::string list;
    for (const std::string& word : words) list += (list.empty() ? "" : ", ") + word;
    throw CLI::ValidationError(option, "'" + text + "' is none of " + list);
}

std::array<bool, 3> axes_from(const std::string& option, const std::string& text) {
    if (text.find_first_not_of("xyz") != std::string::npos)
        throw CLI::ValidationError(option + ": '" + text + "' is not made of the axes x, y and z");
    std::array<bool, 3> axes{false, false, false};
    for (const char axis : text) axes[static_cast<std::size_t>(axis - 'x')] = true;
    return axes;
}

}  // namespace kiln::cli
