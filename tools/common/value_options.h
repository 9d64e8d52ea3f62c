// value_options.h: options that take a plain number between bounds, or one of a few words; a refusal names the option and says why.
#pragma once

#include <CLI/CLI.hpp>
#include <array>
#include <charconv>
#include <cmath>
#include <concepts>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace kiln::cli {

/// Bounds, both included, of what an option takes.
template <typename Number>
struct Bounds {
    Number lower = std::numeric_limits<Number>::lowest();
    Number upper = std::numeric_limits<Number>::max();
};

/// The smallest positive number: the lower bound of what must be greater than zero.
inline constexpr double above_zero = std::numeric_limits<double>::min();

/// As people write it: 0.0003, 1e-14, 1e20.
std::string number_text(double value);

/// The bounds as numbers of double precision, infinite where there is none.
template <typename Number>
Bounds<double> finite_bounds(const Bounds<Number>& bounds) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    return {bounds.lower == std::numeric_limits<Number>::lowest() ? -infinity : static_cast<double>(bounds.lower),
            bounds.upper == std::numeric_limits<Number>::max() ? infinity : static_cast<double>(bounds.upper)};
}

/// What a number outside finite_bounds() is not: "between 1 and 1000", "greater than 0", "0 or more", "in the range of numbers".
std::string not_within(const Bounds<double>& bounds);

/// The same for help texts: " [1 to 1000]", " [above 0]", " [0 or more]", nothing.
std::string known_bounds(const Bounds<double>& bounds);

/// The axes that a text such as "xy" names; none for an empty one. Throws CLI::ValidationError "OPTION: 'xw' is not made of the
/// axes x, y and z".
std::array<bool, 3> axes_from(const std::string& option, const std::string& text);

/// The number that a text says. Throws CLI::ValidationError "OPTION: 'many' is not a number" or "OPTION: 5 is not between 0 and 1".
template <typename Number>
Number number_from(const std::string& option, const std::string& text, const Bounds<Number>& bounds) {
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool number = error != std::errc::invalid_argument && end == text.data() + text.size() && !text.ends_with('.') &&
                        std::isfinite(static_cast<double>(value));
    if (!number)
        throw CLI::ValidationError(option, "'" + text + "' is not a " + (std::integral<Number> ? "whole " : "") + "number");
    if (error == std::errc() && value >= bounds.lower && value <= bounds.upper) return value;
    throw CLI::ValidationError(option, text + " is not " + not_within(finite_bounds(bounds)));
}

/// Adds an option that takes a plain number into target. Its value before is shown as the default.
template <typename Number>
CLI::Option* add_number(CLI::App& app, const std::string& name, Number& target, const Bounds<std::type_identity_t<Number>>& bounds,
                        const std::string& help) {
    CLI::Option* option = app.add_option_function<std::string>(
        name,
        [&target, option = name.substr(name.rfind(',') + 1), bounds](const std::string& text) {
            target = number_from<Number>(option, text, bounds);
        },
        help + known_bounds(finite_bounds(bounds)));
    return option->type_name(std::integral<Number> ? "N" : "NUMBER")->default_str(number_text(static_cast<double>(target)));
}

/// What a word of the command line stands for.
template <typename Value>
using Choices = std::vector<std::pair<std::string, Value>>;

/// The place of a text among the words; throws CLI::ValidationError "OPTION: 'x' is none of a, b".
std::size_t choice_from(const std::string& option, const std::string& text, const std::vector<std::string>& words);

/// Adds an option that takes one of a few words into target. The word of its value before is shown as the default.
template <typename Value>
CLI::Option* add_choice(CLI::App& app, const std::string& name, Value& target,
                        const Choices<std::type_identity_t<Value>>& choices, const std::string& help) {
    std::vector<std::string> words;
    std::string list, standard;
    for (const auto& [word, value] : choices) {
        words.push_back(word);
        list += (list.empty() ? "" : ",") + word;
        if (value == target) standard = word;
    }
    CLI::Option* option = app.add_option_function<std::string>(
        name,
        [&target, name, words, choices](const std::string& text) { target = choices[choice_from(name, text, words)].second; },
        help);
    return option->type_name("{" + list + "}")->default_str(standard);
}

}  // namespace kiln::cli
