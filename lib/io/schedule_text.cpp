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

}  // namespace

physics::Schedule parse_schedule(const std::string& text) {
    std::istringstream words(text);
    std::string word;
    words >> word;
    const auto first = quantity(word, Dimension::temperature);
    if (!first) refuse(word, "a temperature");
    std::vector<physics::Schedule::Corner> corners{{0.0, *first}};
    while (words >> word) {
        const physics::Schedule::Corner last = corners.back();
        if (const auto hold = quantity(word, Dimension::time)) {
            if (!(*hold >= 0.0)) refuse(word, "a time that is not negative");
            corners.push_back({last.time + *hold, last.temperature});
            continue;
        }
        const auto rate = quantity(word, Dimension::heating_rate);
        if (!rate) refuse(word, "a rate or the time of a hold");
        if (!(*rate > 0.0)) refuse(word, "a rate above zero, whether it heats or cools,");
        word.clear();
        words >> word;
        const auto next = quantity(word, Dimension::temperature);
        if (!next) refuse(word, "the temperature that the ramp leads to");
        corners.push_back({last.time + std::abs(*next - last.temperature) / *rate, *next});
    }
    if (corners.size() == 1) throw TextError("one temperature alone never ends; --temperature holds it");
    return physics::Schedule(std::move(corners));
}

}  // namespace kiln::io
