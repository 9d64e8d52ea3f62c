// csv.cpp: reads tables of measurements.
#include "io/csv.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fstream>

#include "core/types.h"

namespace kiln::io {

namespace {

std::string trimmed(std::string text) {
    const auto outer = [](char c) { return std::isspace(static_cast<unsigned char>(c)) != 0 || c == '"'; };
    while (!text.empty() && outer(text.back())) text.pop_back();
    text.erase(text.begin(), std::ranges::find_if_not(text, outer));
    return text;
}

std::vector<std::string> fields(const std::string& line, char separator) {
    std::vector<std::string> list;
    for (std::size_t start = 0; start <= line.size();) {
        const std::size_t end = std::min(line.find(separator, start), line.size());
        list.push_back(trimmed(line.substr(start, end - start)));
        start = end + 1;
    }
    return list;
}

double number_of(std::string text, char separator, const std::string& place) {
    if (separator != ',') std::ranges::replace(text, ',', '.');
    double number = 0.0;
    const char* first = text.data() + (text.starts_with('+') ? 1 : 0);
    const auto [end, error] = std::from_chars(first, text.data() + text.size(), number);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(number))
        throw Error(place + ": '" + text + "' is not a number");
    return number;
}

std::string lower(std::string text) {
    std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

/// "Force (N)": the part behind the name, without what encloses it.
std::string unit_of(const std::string& heading) {
    std::size_t mark = heading.find_first_of("([");
    if (mark == std::string::npos) mark = heading.find_last_of("/_");
    if (mark == std::string::npos) return "";
    std::string unit = heading.substr(mark + 1);
    while (!unit.empty() && (unit.back() == ')' || unit.back() == ']' || unit.back() == ' ')) unit.pop_back();
    unit = trimmed(unit);
    for (const char* micro : {"\u00b5", "\u03bc"})  // the micro sign and the Greek letter
        if (unit.starts_with(micro)) unit = std::string(1, 'u').append(unit, 2);
    return unit;
}

}  // namespace

CsvTable::CsvTable(const std::string& file) : file_(file) {
    std::ifstream stream(file);
    if (!stream) throw Error(file + ": cannot be opened");
    char separator = ',';
    std::size_t number = 0;
    for (std::string line; std::getline(stream, line);) {
        ++number;
        if (number == 1 && line.starts_with("\xef\xbb\xbf")) line.erase(0, 3);  // byte order mark of spreadsheets
        if (trimmed(line).empty() || line.starts_with('#')) continue;
        const std::string place = file + ", line " + std::to_string(number);
        if (headings_.empty()) {
            separator = line.find(';') != std::string::npos ? ';' : line.find('\t') != std::string::npos ? '\t' : ',';
            headings_ = fields(line, separator);
            columns_.resize(headings_.size());
            continue;
        }
        const std::vector<std::string> row = fields(line, separator);
        if (row.size() != headings_.size())
            throw Error(place + ": has " + std::to_string(row.size()) + " columns, the heading has " +
                        std::to_string(headings_.size()));
        for (std::size_t column = 0; column < row.size(); ++column)
            columns_[column].push_back(number_of(row[column], separator, place));
    }
    if (stream.bad()) throw Error(file + ": cannot be read");
    if (headings_.empty() || columns_.front().empty()) throw Error(file + ": has no rows of numbers");
}

std::optional<std::vector<double>> CsvTable::column(const std::vector<std::string>& names, Dimension dimension) const {
    std::optional<std::size_t> found;
    for (std::size_t column = 0; column < headings_.size(); ++column) {
        const std::string heading = lower(headings_[column]);
        if (std::ranges::none_of(names, [&](const std::string& name) { return heading.starts_with(name); })) continue;
        if (found)
            throw Error(file_ + ": the columns '" + headings_[*found] + "' and '" + headings_[column] + "' may both be meant");
        found = column;
    }
    if (!found) return std::nullopt;
    std::vector<double> values = columns_[*found];
    if (dimension == Dimension::none) return values;
    const std::string unit = unit_of(headings_[*found]);
    try {
        const double zero = parse_quantity("0" + unit, dimension), one = parse_quantity("1" + unit, dimension);
        for (double& value : values) value = zero + (one - zero) * value;
    } catch (const TextError&) {
        const std::string given = unit.empty() ? "has no unit" : "has the unit '" + unit + "'";
        throw Error(file_ + ": column '" + headings_[*found] + "' " + given + "; known here: " + known_units(dimension));
    }
    return values;
}

std::vector<double> CsvTable::required(const std::vector<std::string>& names, Dimension dimension) const {
    auto values = column(names, dimension);
    if (!values) throw Error(file_ + ": has no column '" + names.front() + "'");
    return *values;
}

bool is_csv(const std::string& file) { return lower(file).ends_with(".csv"); }

}  // namespace kiln::io
