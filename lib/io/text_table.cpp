// text_table.cpp: finds the table in the text of an export.
#include "io/text_table.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>

#include "core/types.h"
#include "io/quantity.h"

namespace kiln::io {

namespace {

constexpr std::string_view no_break_space = "\u00a0";
constexpr std::string_view minus_sign = "\u2212";
constexpr std::string_view example = "such as 'deflection (mm),force (N)'";
/// What programs write for a value that is missing.
constexpr std::array<std::string_view, 8> missing{"", "-", "--", "---", "nan", "NaN", "n/a", "N/A"};

std::string_view trimmed(std::string_view text) {
    for (bool more = true; more;) {
        more = false;
        for (const std::string_view blank : {std::string_view(" "), std::string_view("\t"), no_break_space}) {
            if (text.starts_with(blank)) text.remove_prefix(blank.size()), more = true;
            if (text.ends_with(blank)) text.remove_suffix(blank.size()), more = true;
        }
    }
    return text;
}

struct Line {
    std::size_t number;  // from 1
    std::string_view text;
};

/// Line ends of all systems.
std::vector<Line> lines_of(std::string_view text) {
    std::vector<Line> lines;
    for (std::size_t number = 1; !text.empty(); ++number) {
        const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
        lines.push_back({number, text.substr(0, end)});
        text.remove_prefix(std::min(end + (text.substr(end).starts_with("\r\n") ? 2 : 1), text.size()));
    }
    return lines;
}

/// Where the cell that begins with a quotation mark at `start` has its last one; nothing where it has none before the next
/// separator: then the mark is one of inches, or a mistake.
std::optional<std::size_t> closing_quote(std::string_view line, std::size_t start, char separator) {
    for (std::size_t at = start + 1; at < line.size(); ++at) {
        if (line[at] != '"') continue;
        if (line.substr(at + 1).starts_with('"')) {
            ++at;
            continue;
        }
        const std::size_t next = line.find_first_not_of(separator == '\t' ? " " : " \t", at + 1);
        if (next == std::string_view::npos || line[next] == separator) return at;
    }
    return std::nullopt;
}

bool in_brackets(std::string_view cell) {
    return (cell.starts_with('(') && cell.ends_with(')')) || (cell.starts_with('[') && cell.ends_with(']'));
}

void add_cells(std::vector<std::string_view>& cells, std::string_view line, char separator) {
    for (std::size_t at = 0;; ++at) {
        const std::size_t start = std::min(line.find_first_not_of(separator == '\t' ? " " : " \t", at), line.size());
        const auto close = start < line.size() && line[start] == '"' ? closing_quote(line, start, separator) : std::nullopt;
        const std::size_t end = std::min(line.find(separator, close.value_or(at)), line.size());
        cells.push_back(trimmed(close ? line.substr(start + 1, *close - start - 1) : line.substr(at, end - at)));
        if (end == line.size()) return;
        at = end;
    }
}

/// The digits as from_chars reads them; nothing for a text with more than one comma or point.
std::optional<std::string> plain_number(std::string_view cell) {
    std::string plain;
    if (cell.starts_with(minus_sign)) {
        plain = "-";
        cell.remove_prefix(minus_sign.size());
    } else if (cell.starts_with('+') && !cell.substr(1).starts_with('-')) {
        cell.remove_prefix(1);
    }
    plain += cell;
    const std::size_t mark = plain.find_first_of(",.");
    if (mark == std::string::npos) return plain;
    if (plain.find_first_of(",.", mark + 1) != std::string::npos) return std::nullopt;
    plain[mark] = '.';
    return plain;
}

/// True for what has the form of a number, even one that is out of range.
bool has_form_of_number(std::string_view cell) {
    if (cell.empty() || cell.find_first_of("0123456789") == std::string_view::npos) return false;
    const auto plain = plain_number(cell);
    if (!plain) return false;
    double number = 0.0;
    const auto [end, error] = std::from_chars(plain->data(), plain->data() + plain->size(), number);
    return error != std::errc::invalid_argument && end == plain->data() + plain->size();
}

/// "10,000" and not "0,741" nor "10,00": the comma may mark thousands.
bool has_form_of_thousands(std::string_view cell) {
    if (cell.starts_with('-') || cell.starts_with('+')) cell.remove_prefix(1);
    const std::size_t comma = cell.find(',');
    return comma >= 1 && comma <= 3 && cell[0] != '0' && cell.size() == comma + 4 &&
           cell.find_first_not_of("0123456789,") == std::string_view::npos;
}

/// Cells that blanks and tabs separate; "x (m)" is one, and so is "# x".
void add_blank_separated(std::vector<std::string_view>& cells, std::string_view line) {
    const std::size_t first = cells.size();
    for (std::size_t at = line.find_first_not_of(" \t"); at < line.size(); at = line.find_first_not_of(" \t", at)) {
        const std::size_t end = std::min(line.find_first_of(" \t", at), line.size());
        const std::string_view cell = line.substr(at, end - at);
        if (cells.size() > first && (in_brackets(cell) || cells.back() == "#"))
            cells.back() = {cells.back().data(), static_cast<std::size_t>(cell.data() + cell.size() - cells.back().data())};
        else
            cells.push_back(cell);
        at = end;
    }
    if (cells.size() == first) cells.emplace_back();
}

struct Row {
    std::size_t line, first, count;  // count: of cells
    std::size_t filled;              // count without the empty cells at the end
    std::string numbers;             // a 1 for every cell that has the form of a number, up to the last of these
    bool remark;                     // begins with #
};

/// A text in cells, blank rows left out.
struct Grid {
    std::vector<std::string_view> cells;
    std::vector<Row> rows;

    [[nodiscard]] std::string_view cell(const Row& row, std::size_t column) const { return cells[row.first + column]; }
};

Grid split(const std::vector<Line>& lines, char separator) {
    Grid grid;
    for (const Line& line : lines) {
        Row row{line.number, grid.cells.size(), 0, 0, "", false};
        if (separator == ' ')
            add_blank_separated(grid.cells, line.text);
        else
            add_cells(grid.cells, line.text, separator);
        row.count = grid.cells.size() - row.first;
        for (std::size_t column = 0; column < row.count; ++column) {
            if (!grid.cell(row, column).empty()) row.filled = column + 1;
            row.numbers += has_form_of_number(grid.cell(row, column)) ? '1' : '0';
        }
        row.numbers.erase(row.numbers.find_last_of('1') + 1);
        row.remark = grid.cell(row, 0).starts_with('#');
        if (row.filled == 0)
            grid.cells.resize(row.first);
        else
            grid.rows.push_back(std::move(row));
    }
    return grid;
}

/// The places of the numbers in most rows; empty where no row has one.
std::string common_numbers(const Grid& grid) {
    std::map<std::string, std::size_t> counts;
    for (const Row& row : grid.rows)
        if (!row.remark && !row.numbers.empty()) ++counts[row.numbers];
    const auto rank = [](const auto& entry) { return std::pair(entry.second, std::ranges::count(entry.first, '1')); };
    const auto found = std::ranges::max_element(counts, {}, rank);
    return found == counts.end() ? "" : found->first;
}

/// "(mm)" or "mm" is mm.
std::string_view without_brackets(std::string_view cell) {
    return in_brackets(cell) ? trimmed(cell.substr(1, cell.size() - 2)) : cell;
}

/// Cells of a row with a unit, known or in brackets; names such as d and T may look like one.
std::size_t units_in(const Grid& grid, const Row& row) {
    std::size_t count = 0;
    for (std::size_t column = 0; column < row.filled; ++column)
        if (const std::string_view cell = grid.cell(row, column); in_brackets(cell) || is_unit(cell)) ++count;
    return count;
}

/// The rows of a table in a grid.
struct Layout {
    char separator;
    Grid grid;
    std::string numbers;                // places of numbers in its rows
    const Row* heading = nullptr;       // nothing: no row of words stands above its rows
    const Row* units = nullptr;
    std::vector<const Row*> body;
    std::size_t width = 0;              // number of columns
};

/// True where all rows have the same number of cells: only then do blanks separate cells, and not words of one.
bool is_regular(const Layout& layout) {
    return !layout.body.empty() && layout.width > 1 &&
           std::ranges::all_of(layout.body, [&](const Row* row) { return row->count == layout.width; });
}

Layout layout_of(const std::vector<Line>& lines, char separator) {
    Layout layout{separator, split(lines, separator), "", nullptr, nullptr, {}, 0};
    const std::vector<Row>& rows = layout.grid.rows;
    layout.numbers = common_numbers(layout.grid);
    if (layout.numbers.empty()) return layout;
    const auto first =
        std::ranges::find_if(rows, [&](const Row& row) { return !row.remark && row.numbers == layout.numbers; });
    std::vector<const Row*> words;
    bool all_remarks = true;
    for (auto row = rows.begin(); row != first; ++row)
        if (row->numbers.empty() && row->filled >= layout.numbers.size()) {
            words.push_back(&*row);
            all_remarks &= row->remark;
        }
    if (!all_remarks) std::erase_if(words, [](const Row* row) { return row->remark; });
    if (words.empty()) return layout;
    layout.heading = words.back();
    if (words.size() > 1 && units_in(layout.grid, *words.back()) > units_in(layout.grid, *words[words.size() - 2])) {
        layout.units = words.back();
        layout.heading = words[words.size() - 2];
    }
    for (auto row = rows.begin(); row != first && !layout.units; ++row)  // units of the first columns only
        if (row->line > layout.heading->line && row->numbers.empty() && !row->remark && units_in(layout.grid, *row) > 0)
            layout.units = &*row;
    const std::size_t last_line = layout.units ? layout.units->line : layout.heading->line;
    for (const Row& row : rows)
        if (row.line > last_line && !row.remark) layout.body.push_back(&row);
    layout.width = layout.heading->filled;
    return layout;
}

/// The rows of numbers of a text whose columns have been named.
Layout layout_without_heading(const std::vector<Line>& lines, char separator) {
    Layout layout{separator, split(lines, separator), "", nullptr, nullptr, {}, 0};
    layout.numbers = common_numbers(layout.grid);
    for (const Row& row : layout.grid.rows)
        if (!row.remark && !layout.numbers.empty() && (!layout.body.empty() || row.numbers == layout.numbers))
            layout.body.push_back(&row);
    if (!layout.body.empty()) layout.width = layout.body.front()->filled;
    return layout;
}

/// The same with the separator that gives so many columns.
Layout layout_of_columns(const std::vector<Line>& lines, std::size_t columns, const std::string& name) {
    std::optional<Layout> widest;
    for (const char separator : {';', '\t', ',', ' '}) {
        Layout layout = layout_without_heading(lines, separator);
        if (layout.width == columns && (separator != ' ' || is_regular(layout) || columns == 1)) return layout;
        if (!widest || layout.width > widest->width) widest = std::move(layout);
    }
    if (widest->body.empty()) throw Error(name + ": has no rows of numbers");
    throw Error(name + ", line " + std::to_string(widest->body.front()->line) + ": has " + std::to_string(widest->width) +
                (widest->width == 1 ? " column" : " columns") + ", and " + std::to_string(columns) + " are named");
}

/// The character of a first line "sep=;", as spreadsheets write it.
std::optional<char> stated_separator(const std::vector<Line>& lines) {
    if (lines.empty()) return std::nullopt;
    std::string_view line = lines.front().text;
    while (line.starts_with('"')) line.remove_prefix(1);
    while (line.ends_with('"')) line.remove_suffix(1);
    if (line.size() != 5 || !(line.starts_with("sep=") || line.starts_with("SEP="))) return std::nullopt;
    return line[4];
}

/// The layout with the separator that gives a table of several columns, or of one.
Layout found_layout(std::vector<Line> lines, const std::string& name) {
    std::string separators = ";\t, ";
    if (const auto stated = stated_separator(lines)) {
        separators = *stated;
        lines.erase(lines.begin());
    }
    std::optional<Layout> found;
    for (const char separator : separators) {
        Layout layout = layout_of(lines, separator);
        if (separator == ' ' && !is_regular(layout)) layout.heading = nullptr;
        if (layout.heading && layout.heading->filled > 1) return layout;
        if (layout.heading || !found) found = std::move(layout);
    }
    if (found->heading) return std::move(*found);
    const std::vector<Row>& rows = found->grid.rows;
    const auto with_numbers = std::ranges::find_if(rows, [](const Row& row) { return !row.remark && !row.numbers.empty(); });
    if (rows.empty() || with_numbers == rows.end())
        throw Error(name + ": has no rows of numbers" +
                    (rows.empty() ? "" : "; line " + std::to_string(rows[0].line) + " is " +
                                             excerpt(lines[rows[0].line - lines[0].number].text)));
    throw Error(name + ", line " + std::to_string(with_numbers->line) + ": has numbers and no heading above them, " +
                std::string(example));
}

/// Throws Error for rows that do not fit the heading, and words among numbers.
void check_rows(const Layout& layout, const std::string& name) {
    const std::size_t width = layout.width;
    for (const Row* row : layout.body) {
        const std::string place = name + ", line " + std::to_string(row->line);
        if (row->count < width || row->filled > width) {
            const std::size_t columns = row->count < width ? row->count : row->filled;
            throw Error(place + ": has " + std::to_string(columns) + (columns == 1 ? " column" : " columns") +
                        ", the heading has " + std::to_string(width));
        }
        for (std::size_t column = 0; column < layout.numbers.size(); ++column) {
            const std::string_view cell = layout.grid.cell(*row, column);
            if (layout.numbers[column] == '1' && !has_form_of_number(cell) && std::ranges::find(missing, cell) == missing.end())
                throw Error(place + ": " + excerpt(cell) + " is not a number");
        }
    }
}

/// Whether commas mark decimals. Throws Error where that is not clear.
bool has_decimal_commas(const Layout& layout, const std::string& name) {
    const Row *comma_row = nullptr, *point_row = nullptr;
    std::string_view comma, point;
    bool all_thousands = true;
    for (const Row* row : layout.body)
        for (std::size_t column = 0; column < std::min(row->numbers.size(), layout.numbers.size()); ++column) {
            const std::string_view cell = layout.grid.cell(*row, column);
            if (row->numbers[column] != '1' || layout.numbers[column] != '1') continue;
            if (cell.find('.') != std::string_view::npos && !point_row) point_row = row, point = cell;
            if (cell.find(',') == std::string_view::npos) continue;
            if (!comma_row) comma_row = row, comma = cell;
            all_thousands &= has_form_of_thousands(cell);
        }
    if (!comma_row) return false;
    const std::string place = name + ", line " + std::to_string(comma_row->line) + ": " + excerpt(comma);
    if (point_row)
        throw Error(place + " has a comma and " + excerpt(point) + " in line " + std::to_string(point_row->line) +
                    " a point; write all numbers with the same mark of decimals and none of thousands");
    if (all_thousands)
        throw Error(place + " and all other commas stand before three digits, so they may mark thousands; write decimals with a "
                            "point, or thousands without a mark");
    return true;
}

}  // namespace

TextTable table_in(std::string_view text, const std::string& name, std::size_t columns) {
    const Layout layout = columns > 0 ? layout_of_columns(lines_of(text), columns, name) : found_layout(lines_of(text), name);
    check_rows(layout, name);
    TextTable table;
    table.decimal_comma = has_decimal_commas(layout, name);
    const std::size_t width = layout.width;
    const auto row_of = [&](const Row& row) {
        std::vector<std::string_view> cells(width);
        for (std::size_t column = 0; column < std::min(width, row.count); ++column) cells[column] = layout.grid.cell(row, column);
        if (row.remark) cells[0] = trimmed(cells[0].substr(std::min(cells[0].find_first_not_of('#'), cells[0].size())));
        return cells;
    };
    if (layout.heading) table.headings = row_of(*layout.heading);
    if (layout.units) {
        table.units = row_of(*layout.units);
        std::ranges::transform(table.units, table.units.begin(), without_brackets);
    }
    for (const Row* row : layout.body) {
        table.lines.push_back(row->line);
        for (std::size_t column = 0; column < width; ++column) table.cells.push_back(layout.grid.cell(*row, column));
    }
    return table;
}

std::optional<double> number_in(std::string_view cell, bool decimal_comma) {
    const auto plain = plain_number(cell);
    if (!plain || (!decimal_comma && cell.find(',') != std::string_view::npos)) return std::nullopt;
    double number = 0.0;
    const auto [end, error] = std::from_chars(plain->data(), plain->data() + plain->size(), number);
    if (error != std::errc() || end != plain->data() + plain->size() || !std::isfinite(number)) return std::nullopt;
    return number;
}

std::string excerpt(std::string_view text) {
    constexpr std::size_t longest = 40;  // bytes
    std::size_t length = std::min(text.size(), longest);
    while (length < text.size() && (static_cast<unsigned char>(text[length]) & 0xc0) == 0x80) --length;  // within a character
    std::string shown = "'";
    shown.append(text.substr(0, length)).append(length < text.size() ? "...'" : "'");
    return shown;
}

}  // namespace kiln::io
