// measured_test.h: bending tests of testing machines, from the tables that these export.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "io/csv.h"
#include "io/document.h"

namespace kiln::analyze {

/// Which columns of a table are meant, where the headings do not say it.
struct ColumnOptions {
    std::string force, deflection;  // headings; empty: the known ones

    void add_to(CLI::App& app);

    /// Throws Error if one is given: a document names its parts itself.
    void refuse_with_documents() const;
};

/// Adds an option that stays empty unless it is given, and must be positive then.
void add_optional(CLI::App& app, const std::string& name, std::optional<double>& target, io::Dimension dimension,
                  const std::string& help);

/// Sizes of the bar and its fixture, m.
struct BarOptions {
    std::optional<double> span, width, height;
    bool allow_block = false;

    void add_to(CLI::App& app);

    /// That of the key "span", "width" or "height": as given, else the document's. Throws Error where neither has it.
    [[nodiscard]] double size(const io::Document& document, const std::string& key) const;

    /// Throws Error for a block, unless blocks are allowed, here or in its test.
    void refuse_block(const io::Document& document) const;

    /// The document's "warnings", but for one on its slenderness where that is another here.
    [[nodiscard]] std::vector<std::string> warnings(const io::Document& document) const;

    /// What to know of a beam on the span and height of the test, where its "warnings" do not say it.
    [[nodiscard]] std::optional<std::string> short_bar_warning(const io::Document& document,
                                                               std::optional<double> shear_correction) const;
};

/// Headings of forces, of deflections by a gauge at the bar, and of travels of the machine.
extern const io::ColumnNames force_names, gauge_names, travel_names;

/// Force against deflection of a test.
struct Curve {
    std::vector<double> deflection;  // m
    std::vector<double> punch;       // m
    std::vector<double> force;       // N
};

/// The curve of a dem-bend document. Throws Error naming what it lacks.
Curve curve_of(const io::Document& document);

/// The test of a table as the document that bend would have written, but for the sizes of the bar. The deflection is that of a
/// gauge, else the travel of the machine. `columns` has the headings that were read, `turned` those whose signs were turned
/// because machines may count compression negative. Without a deflection, where none is required, the curve has only forces.
/// Throws Error naming the file.
io::Document measured_test(const io::CsvTable& table, const std::string& file, const ColumnOptions& options, bool needs_deflection);

/// True for a document that measured_test() made.
bool is_measured(const io::Document& document);

/// "bar7.csv: compression counts negative: the signs of force, deflection are turned"; for a test in which some are.
std::string turned_sentence(const io::Document& document);

/// Writes a picture to a file, whole or not at all; nothing for an empty name.
void write_plot(const std::string& file, const std::string& svg);

}  // namespace kiln::analyze
