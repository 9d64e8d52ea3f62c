// text_table.h: where the table stands in a text of cells: its separator, heading, units, rows, and how its numbers are written.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace kiln::io {

/// The cells of a table, parts of the text that it was found in, without blanks and quotation marks around them.
struct TextTable {
    std::vector<std::string_view> headings;
    std::vector<std::string_view> units;  // the row below the headings; empty where there is none
    std::vector<std::string_view> cells;  // row by row, as many as headings in each
    std::vector<std::size_t> lines;       // of the text, from 1, that the rows stand in
    bool decimal_comma = false;
};

/// The table of a text in UTF-8, whose cells are separated by semicolons, tabs or commas, or as its first line "sep=;" says, or by
/// blanks where all rows then have the same number of cells.
/// Its rows are those with numbers in the same places as most rows of the text have them; its heading is the nearest row of words
/// above, which may begin with #. What stands above that is a report and not read. Blank rows, other lines that begin with #, and
/// separators at the ends of rows say nothing.
/// Throws Error that begins with `name` and the line for a text without such a table, a row of another length, a word in a column
/// of numbers, and numbers of which it is not clear whether their commas mark decimals.
/// columns: if not 0, so many columns have been named already, and the text's own heading, if it has one, is not read.
TextTable table_in(std::string_view text, const std::string& name, std::size_t columns = 0);

/// The number that a cell says; nothing if it is none.
std::optional<double> number_in(std::string_view cell, bool decimal_comma);

/// A piece of text for a sentence: in quotation marks, the end of a long one left out.
std::string excerpt(std::string_view text);

}  // namespace kiln::io
