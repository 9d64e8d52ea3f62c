// json_values.cpp: numbers, texts and unknown keys of JSON.
#include "io/json_values.h"

#include <cmath>

#include "core/types.h"

namespace kiln::io {

namespace {

constexpr std::size_t longest_shown = 60;  // bytes of a datum in a message

}  // namespace

void put_back(Json& target, const Json& carried) {
    if (target.is_object() && carried.is_object()) {
        for (const auto& [key, value] : carried.items()) {
            if (target.contains(key))
                put_back(target[key], value);
            else
                target[key] = value;
        }
    } else if (target.is_array() && carried.is_array() && target.size() == carried.size()) {
        for (std::size_t index = 0; index < target.size(); ++index) put_back(target[index], carried[index]);
    }
}

double number_from(const Json& json, const std::string& where, double lowest) {
    if (!json.is_number() || !std::isfinite(json.get<double>())) throw Error(where + " is " + shown(json) + ", not a number");
    if (json.get<double>() < lowest) throw Error(where + " is " + shown(json) + ", below " + shown(lowest));
    return json.get<double>();
}

void check_finite(const Json& json, const std::string& where) {
    if (json.is_number_float() && !std::isfinite(json.get<double>())) throw Error(where + " is not a finite number");
    if (json.is_structured())
        for (const auto& [key, value] : json.items()) check_finite(value, where + "." + key);
}

std::string text_of(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

Json carried_json(const std::string& text, const std::string& what) {
    Json json = Json::parse(text, nullptr, false);
    if (json.is_discarded()) throw Error(what + " is not JSON");
    return json;
}

std::string clipped(const std::string& text) {
    if (text.size() <= longest_shown) return text;
    std::size_t length = longest_shown;
    while (length > 0 && (static_cast<unsigned char>(text[length]) & 0xC0) == 0x80) --length;  // not inside a UTF-8 character
    return text.substr(0, length) + "…";
}

std::string shown(const Json& json) { return clipped(text_of(json)); }

}  // namespace kiln::io
