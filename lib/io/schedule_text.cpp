// schedule_text.cpp: words of a schedule into corners.
#include "io/schedule_text.h"

#include <cmath>
#include <optional>
#include <sstream>
#include <vector>

#include "core/types.h"
#include "io/quantity.h"

namespace kiln::io {

namespace {

std::optional<double> quantity(const std::string& word, Dimension dimension) {
    try {
        return parse_quantity(word, dimension);
    } catch (const TextError&) {
        return std::nullopt;
    }
}

[[noreturn]] void refuse(const std::string& word, const std::string& required) {
    throw TextError((word.empty() ? "it ends" : "'" + word + "' stands") + " where " + required +
                    " is required, as in \"25C 10K/min 1200C 1h 10K/min 25C\"");
}

/// "a temperature [K, C, or RT]".
std::string with_units(const std::string& what, Dimension dimension, const std::string& more = "") {
    return what + " [" + known_units(dimension) + more + "]";
}

/// The words of a text; a number and the unit behind it are one, whether or not a blank stands between them.
std::vector<std::string> words_of(const std::string& text) {
    std::istringstream stream(text);
    std::vector<std::string> words;
    bool number = false;  // the last word is one without a unit
    for (std::string word; stream >> word;) {
        const bool begins_one = word.find_first_of("0123456789.+-") == 0;
        if (number && !begins_one)
            words.back() += " " + word;
        else
            words.push_back(word);
        number = begins_one && word.find_first_not_of("0123456789.+-eE") == std::string::npos;
    }
    return words;
}

}  // namespace

physics::Schedule parse_schedule(const std::string& text) {
    const std::vector<std::string> words = words_of(text);
    std::size_t at = 0;
    const auto next = [&] { return at < words.size() ? words[at++] : ""; };
    const std::string begin = next();
    const auto first = quantity(begin, Dimension::temperature);
    if (!first) refuse(begin, with_units("a temperature", Dimension::temperature, " or RT"));
    std::vector<physics::Schedule::Corner> corners{{0.0, *first}};
    while (at < words.size()) {
        const physics::Schedule::Corner last = corners.back();
        const std::string word = next();
        if (const auto hold = quantity(word, Dimension::time)) {
            if (!(*hold >= 0.0)) refuse(word, "a time that is not negative");
            corners.push_back({last.time + *hold, last.temperature});
            continue;
        }
        const auto rate = quantity(word, Dimension::heating_rate);
        if (!rate)
            refuse(word,
                   with_units("a rate", Dimension::heating_rate) + " or " + with_units("the time of a hold", Dimension::time));
        if (!(*rate > 0.0)) refuse(word, "a rate above zero, whether it heats or cools,");
        const std::string goal = next();
        const auto temperature = quantity(goal, Dimension::temperature);
        if (!temperature) refuse(goal, with_units("the temperature that the ramp leads to", Dimension::temperature, " or RT"));
        corners.push_back({last.time + std::abs(*temperature - last.temperature) / *rate, *temperature});
    }
    if (corners.size() == 1) throw TextError("one temperature alone never ends; --temperature holds it");
    return physics::Schedule(std::move(corners));
}

}  // namespace kiln::io
