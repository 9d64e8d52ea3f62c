// results.cpp: checks on the documents of test results.
#include "tools/analyze/results.h"

#include <algorithm>
#include <limits>

#include "io/state_io.h"
#include "io/json_values.h"

namespace kiln::analyze {

void expect_format(const io::Document& document, std::initializer_list<const char*> wanted, const std::string& tool) {
    const Json format = document.header.value("format", Json("dem-state"));
    std::string known;
    for (const char* name : wanted) {
        known += (known.empty() ? "" : " or ") + std::string(name);
        if (format != name) continue;
        const Json version = document.header.value("version", Json(io::format_version));
        if (version != io::format_version)
            throw Error("has version " + version.dump() + ", this program knows version " +
                        std::to_string(io::format_version));
        return;
    }
    const std::string found = format.is_string() ? format.get<std::string>() : format.dump();
    throw Error("is " + found + ", " + tool + " reads " + known);
}

double number_at(const io::Document& document, const std::string& key, double lowest) {
    if (!document.header.contains(key)) throw Error("has no " + key);
    return io::number_from(document.header[key], key, lowest);
}

double positive_at(const io::Document& document, const std::string& key) {
    const double number = number_at(document, key, 0.0);
    if (number == 0.0) throw Error(key + " is zero, expected a positive number");
    return number;
}

std::vector<double> numbers_at(const io::Document& document, const std::string& object, const std::string& key) {
    const std::string where = object + "." + key;
    const Json& header = document.header;
    if (!header.contains(object) || !header[object].is_object() || !header[object].contains(key))
        throw Error("has no " + where);
    const Json& list = header[object][key];
    if (!list.is_array()) throw Error(where + " is not a list of numbers");
    std::vector<double> numbers;
    for (std::size_t row = 0; row < list.size(); ++row)
        numbers.push_back(io::number_from(list[row], where + ", row " + std::to_string(row),
                                          std::numeric_limits<double>::lowest()));
    return numbers;
}

std::vector<std::string> warnings_at(const io::Document& document) {
    const auto found = document.header.find("warnings");
    if (found == document.header.end()) return {};
    if (!found->is_array() || !std::ranges::all_of(*found, [](const Json& each) { return each.is_string(); }))
        throw Error("warnings is " + io::shown(*found) + ", not a list of sentences");
    return found->get<std::vector<std::string>>();
}

Json joined_materials(const std::vector<Json>& objects) {
    std::vector<std::string> names;
    for (const Json& each : objects) {
        const Json name = each.value("material", Json());
        if (name.is_string() && std::ranges::find(names, name.get<std::string>()) == names.end()) names.push_back(name);
    }
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
    return names.empty() ? Json() : Json(text);
}

}  // namespace kiln::analyze
