// csv.cpp: columns of tables of measurements, and their units.
#include "io/csv.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <fstream>
#include <iterator>

#include "core/types.h"
#include "io/text_encoding.h"

namespace kiln::io {

namespace {

constexpr std::array<std::string_view, 5> table_endings{".csv", ".txt", ".tsv", ".dat", ".asc"};
constexpr std::array<std::string_view, 4> no_units{"-", "1", "\u2013", "\u2014"};  // what stands for none: "porosity [-]"
constexpr std::size_t max_headings = 12;                                           // that a refusal names

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0 || static_cast<unsigned char>(c) >= 0x80; }

/// In lower case, with that of the letters of western Europe: two bytes, of which the second differs by as much as in ASCII.
std::string lower(std::string_view text) {
    std::string result(text);
    for (std::size_t at = 0; at < result.size(); ++at) {
        const auto byte = static_cast<unsigned char>(result[at]);
        if (byte == 0xc3 && at + 1 < result.size()) {
            const auto next = static_cast<unsigned char>(result[++at]);
            if (next >= 0x80 && next <= 0x9e && next != 0x97) result[at] = static_cast<char>(next + 0x20);
        } else {
            result[at] = static_cast<char>(std::tolower(byte));
        }
    }
    return result;
}

std::string_view trimmed(std::string_view text) {
    while (text.starts_with(' ')) text.remove_prefix(1);
    while (text.ends_with(' ')) text.remove_suffix(1);
    return text;
}

struct NameAndUnit {
    std::string_view name, unit;
};

/// "Force (N)", "Force [N]"; also with words behind, if the unit is known.
std::optional<NameAndUnit> in_brackets(std::string_view text) {
    const std::size_t close = text.find_last_of(")]");
    if (close == std::string_view::npos) return std::nullopt;
    const std::size_t open = text.find_last_of("([", close);
    if (open == std::string_view::npos) return std::nullopt;
    const std::string_view unit = trimmed(text.substr(open + 1, close - open - 1));
    if (!trimmed(text.substr(close + 1)).empty() && !is_unit(unit)) return std::nullopt;
    return NameAndUnit{trimmed(text.substr(0, open)), unit};
}

/// "Kraft / N".
std::optional<NameAndUnit> behind_slash(std::string_view text) {
    const std::size_t slash = text.find('/');
    if (slash == std::string_view::npos) return std::nullopt;
    const NameAndUnit found{trimmed(text.substr(0, slash)), trimmed(text.substr(slash + 1))};
    return found.name.empty() || found.unit.empty() ? std::nullopt : std::optional(found);
}

/// "deflection_um", "Kraft in N", "Force, N": a known unit as the last word.
std::optional<NameAndUnit> as_last_word(std::string_view text) {
    const std::size_t mark = text.find_last_of("_ ,");
    if (mark == std::string_view::npos || !is_unit(text.substr(mark + 1))) return std::nullopt;
    std::string_view name = text.substr(0, mark);
    while (name.ends_with(' ') || name.ends_with(',')) name.remove_suffix(1);
    if (name.ends_with(" in")) name.remove_suffix(3);
    return NameAndUnit{trimmed(name), text.substr(mark + 1)};
}

bool has_name(const std::string& heading, std::string_view name) {
    if (name.ends_with('$')) return heading == name.substr(0, name.size() - 1);
    return heading.starts_with(name) && (heading.size() == name.size() || !is_letter(heading[name.size()]));
}

}  // namespace

std::string bytes_of(const std::string& file) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) throw Error(file + ": cannot be opened");
    std::string bytes{std::istreambuf_iterator<char>(stream), {}};
    if (stream.bad()) throw Error(file + ": cannot be read");
    return bytes;
}

CsvTable::CsvTable(const std::string& file) : CsvTable(file, bytes_of(file)) {}

CsvTable::CsvTable(std::string name, std::string bytes)
    : file_(std::move(name)),
      text_(std::make_shared<const std::string>(utf8_text(std::move(bytes), file_))),
      table_(table_in(*text_, file_)) {
    for (std::size_t column = 0; column < table_.headings.size(); ++column)
        headings_.push_back(heading_from(table_.headings[column], table_.units.empty() ? "" : table_.units[column]));
}

CsvTable::CsvTable(std::string name, std::string bytes, const std::vector<std::string>& headings)
    : file_(std::move(name)),
      text_(std::make_shared<const std::string>(utf8_text(std::move(bytes), file_))),
      table_(table_in(*text_, file_, headings.size())) {
    for (const std::string& heading : headings) headings_.push_back(heading_from(heading, ""));
}

CsvTable::Heading CsvTable::heading_from(std::string_view text, std::string_view unit_below) {
    auto found = in_brackets(text);
    if (!found) found = behind_slash(text);
    if (!found) found = as_last_word(text);
    if (found && std::ranges::find(no_units, found->unit) != no_units.end()) found->unit = "";
    if (std::ranges::find(no_units, unit_below) != no_units.end()) unit_below = "";
    Heading heading{std::string(text), lower(found ? found->name : text), std::string(found ? found->unit : "")};
    if (unit_below.empty()) return heading;
    if (!heading.unit.empty() && is_unit(heading.unit)) {
        if (heading.unit != unit_below) heading.unit.append(" and ").append(unit_below);  // which no column has
        return heading;
    }
    return {heading.text + " (" + std::string(unit_below) + ")", heading.name, std::string(unit_below)};
}

std::string CsvTable::heading(std::size_t column) const { return headings_[column].text; }

std::string CsvTable::place(std::size_t row) const { return file_ + ", line " + std::to_string(table_.lines[row]); }

std::string CsvTable::headings_text() const {
    std::string list;
    for (std::size_t column = 0; column < headings_.size() && column < max_headings; ++column)
        list += (column == 0 ? "" : ", ") + excerpt(headings_[column].text);
    return list + (headings_.size() > max_headings ? ", ..." : "");
}

/// Columns with that heading: as it stands there, else but for case and unit.
std::vector<std::size_t> CsvTable::chosen(const std::string& heading) const {
    const Heading given = heading_from(heading, "");
    std::vector<std::size_t> same, alike;
    for (std::size_t column = 0; column < headings_.size(); ++column) {
        const Heading& each = headings_[column];
        if (each.text == heading || (column < table_.headings.size() && table_.headings[column] == heading)) same.push_back(column);
        if (each.name == given.name && (given.unit.empty() || given.unit == each.unit)) alike.push_back(column);
    }
    return same.empty() ? alike : same;
}

std::optional<std::size_t> CsvTable::find(const ColumnNames& names, Dimension dimension, const ColumnChoice& choice) const {
    std::vector<std::size_t> found;
    if (!choice.heading.empty()) {
        found = chosen(choice.heading);
        if (found.empty())
            throw Error(file_ + ": has no column " + excerpt(choice.heading) + " of " + choice.option + "; its headings are " +
                        headings_text());
    } else {
        for (std::size_t column = 0; column < headings_.size(); ++column)
            if (std::ranges::any_of(names, [&](const std::string& name) { return has_name(headings_[column].name, name); }))
                found.push_back(column);
    }
    if (found.empty()) return std::nullopt;
    if (found.size() == 1) return found.front();
    std::vector<std::size_t> fitting;
    std::ranges::copy_if(found, std::back_inserter(fitting), [&](std::size_t column) {
        return scale_of(headings_[column].unit, dimension).has_value();
    });
    if (fitting.size() == 1) return fitting.front();
    const std::string first = excerpt(headings_[found[0]].text), second = excerpt(headings_[found[1]].text);
    const std::string problem = first == second ? "the column " + first + " stands twice"
                                                : "the columns " + first + " and " + second + " may both be meant";
    throw Error(file_ + ": " + problem + (choice.option.empty() || !choice.heading.empty() ? "" : "; choose by " + choice.option));
}

std::size_t CsvTable::get(const ColumnNames& names, Dimension dimension, const ColumnChoice& choice) const {
    const auto found = find(names, dimension, choice);
    if (!found)
        throw Error(file_ + ": has no column '" + names.front() + "'; its headings are " + headings_text() +
                    (choice.option.empty() ? "" : ", of which " + choice.option + " may name one"));
    return *found;
}

std::vector<double> CsvTable::values(std::size_t column, Dimension dimension, const std::string& unit) const {
    const Heading& heading = headings_[column];
    const auto scale = scale_of(heading.unit.empty() ? unit : heading.unit, dimension);
    if (!scale) {
        const std::string known = known_units(dimension);
        throw Error(file_ + ": column " + excerpt(heading.text) + " " +
                    (heading.unit.empty() ? "has no unit" : "has the unit " + excerpt(heading.unit)) +
                    (known.empty() ? ", a plain number is required" : "; known here: " + known));
    }
    std::vector<double> values = numbers(column);
    for (std::size_t row = 0; row < values.size(); ++row) {
        values[row] = scale->si(values[row]);
        if (!std::isfinite(values[row]))
            throw Error(place(row) + ": column " + excerpt(heading.text) + " is out of the range of numbers");
        if (dimension == Dimension::temperature && !(values[row] > 0.0))
            throw Error(place(row) + ": " + excerpt(table_.cells[row * headings_.size() + column]) + " " + heading.unit +
                        " is not above absolute zero");
    }
    return values;
}

std::vector<double> CsvTable::numbers(std::size_t column) const {
    std::vector<double> list;
    for (std::size_t row = 0; row < rows(); ++row) {
        const std::string_view cell = table_.cells[row * headings_.size() + column];
        const auto number = number_in(cell, table_.decimal_comma);
        if (cell.empty()) throw Error(place(row) + ": column " + excerpt(headings_[column].text) + " is empty");
        if (!number) throw Error(place(row) + ": " + excerpt(cell) + " is not a number");
        list.push_back(*number);
    }
    return list;
}

std::optional<std::vector<double>> CsvTable::column(const ColumnNames& names, Dimension dimension) const {
    const auto found = find(names, dimension);
    return found ? std::optional(values(*found, dimension)) : std::nullopt;
}

std::vector<double> CsvTable::required(const ColumnNames& names, Dimension dimension) const {
    return values(get(names, dimension), dimension);
}

bool is_csv(const std::string& file) {
    std::string name = lower(file);
    if (name.ends_with(".gz")) name.erase(name.size() - 3);
    if (std::ranges::none_of(table_endings, [&](std::string_view ending) { return name.ends_with(ending); })) return false;
    std::ifstream stream(file);
    char first = 0;
    return name.ends_with(".csv") || !(stream >> first && first == '{');
}

}  // namespace kiln::io
