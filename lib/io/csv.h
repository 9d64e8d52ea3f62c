// csv.h: tables of measurements with the units in the heading, as laboratories and machines write them.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/quantity.h"
#include "io/text_table.h"

namespace kiln::io {

/// What a heading may begin with, in lower case. Letters may not follow: "load" is in "Load (N)" and not in "Loading rate". A name
/// that ends in $ is the whole heading but for its unit.
using ColumnNames = std::vector<std::string>;

/// An option with which a user names the heading of a column.
struct ColumnChoice {
    std::string option;   // "--force-column"; refusals mention it
    std::string heading;  // that was given, with or without its unit; empty: none
};

/// A table read from text (io/text_encoding.h, io/text_table.h). The unit of a column stands in its heading, "Force (N)", "force
/// [mN]", "Kraft / N", "Weg in mm" or "deflection_um", or in a row below.
class CsvTable {
   public:
    /// Throws Error naming file and line for a file that cannot be read, or where no table can be made out.
    explicit CsvTable(const std::string& file);

    /// The same of the bytes of a file.
    CsvTable(std::string name, std::string bytes);

    /// The same with headings for its columns, in their order, whether or not it has some of its own.
    CsvTable(std::string name, std::string bytes, const std::vector<std::string>& headings);

    /// The column whose heading has one of the names, or that was chosen. Where several have, the one whose unit fits. Nothing if
    /// there is none. Throws Error for several.
    std::optional<std::size_t> find(const ColumnNames& names, Dimension dimension, const ColumnChoice& choice = {}) const;

    /// The same; throws Error that names the headings found if there is none.
    std::size_t get(const ColumnNames& names, Dimension dimension, const ColumnChoice& choice = {}) const;

    /// The values of a column in SI units. Throws Error naming file and line for an empty cell, what is no number, and a unit that
    /// is missing or of another kind.
    /// unit: of a heading that has none.
    std::vector<double> values(std::size_t column, Dimension dimension, const std::string& unit = "") const;

    /// The numbers of a column as they stand, whatever its unit: of one whose heading is more than a name and a unit.
    std::vector<double> numbers(std::size_t column) const;

    /// find() or get(), and values().
    std::optional<std::vector<double>> column(const ColumnNames& names, Dimension dimension) const;
    std::vector<double> required(const ColumnNames& names, Dimension dimension) const;

    /// The heading of a column with its unit, as "Load (N)".
    std::string heading(std::size_t column) const;

    /// A cell as it stands there.
    std::string_view cell(std::size_t row, std::size_t column) const { return table_.cells[row * headings_.size() + column]; }

    /// The name of a column in lower case, without its unit; the unit, empty where there is none.
    const std::string& name(std::size_t column) const { return headings_[column].name; }
    const std::string& unit(std::size_t column) const { return headings_[column].unit; }

    /// "'Time (s)', 'Load (N)'", the end of a long list left out.
    std::string headings_text() const;

    std::size_t columns() const { return headings_.size(); }
    std::size_t rows() const { return table_.lines.size(); }

    /// "bar7.csv, line 12" of the row 0, 1, …
    std::string place(std::size_t row) const;

   private:
    struct Heading {
        std::string text;  // as it stands there
        std::string name;  // in lower case, without its unit
        std::string unit;  // as it stands there; empty where there is none
    };

    static Heading heading_from(std::string_view text, std::string_view unit_below);
    std::vector<std::size_t> chosen(const std::string& heading) const;

    std::string file_;
    std::shared_ptr<const std::string> text_;  // that the cells are parts of
    TextTable table_;
    std::vector<Heading> headings_;
};

/// The bytes of a file. Throws Error that names it.
std::string bytes_of(const std::string& file);

/// True for a file that holds such a table by its name: .csv, or .txt, .tsv, .dat and .asc unless it begins as JSON does; perhaps
/// with .gz behind it.
bool is_csv(const std::string& file);

}  // namespace kiln::io
