// csv.h: tables of measurements with the units in the heading, as laboratories write them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "io/quantity.h"

namespace kiln::io {

/// A table read from text: one heading, then rows of numbers. Columns are separated by semicolons, tabs or commas, whichever the
/// heading has first in this order; with semicolons or tabs a decimal comma is understood. Lines that begin with # are remarks. A
/// heading is a name and a unit: "Force (N)", "force [mN]", "Kraft/N", "deflection_um".
class CsvTable {
   public:
    /// Throws Error naming file and line for a file that cannot be read, a row of another length, or what is no number.
    explicit CsvTable(const std::string& file);

    /// The column whose name begins with one of the names (case does not count), in SI units. Nothing if there is none.
    /// Throws Error for two such columns, or a unit that is missing or of another kind.
    std::optional<std::vector<double>> column(const std::vector<std::string>& names, Dimension dimension) const;

    /// The same; throws Error if there is none.
    std::vector<double> required(const std::vector<std::string>& names, Dimension dimension) const;

   private:
    std::string file_;
    std::vector<std::string> headings_;
    std::vector<std::vector<double>> columns_;
};

/// True for a file whose name says that it is such a table.
bool is_csv(const std::string& file);

}  // namespace kiln::io
