// report.h: what the subcommands write, JSON documents a line each or an aligned table for people.
#pragma once

#include <functional>
#include <initializer_list>
#include <string>
#include <vector>

#include "tools/common/tool.h"
#include "analysis/histogram.h"
#include "io/files.h"

namespace kiln::analyze {

/// A column of the table: the document's key, its heading, and its unit ("m" and "Pa" get a prefix, "" is a plain number or word).
struct Column {
    std::string key;
    std::string heading;
    std::string unit;
};

/// A prefix of units.
struct Prefix {
    double factor;
    const char* name;
};

/// The prefix that leaves a value between 1 and 1000, or the nearest there is.
Prefix prefix_of(double value);

/// Adds --table to the app.
void add_table(CLI::App& app, bool& table);

/// To be called once options are parsed: throws CLI::ValidationError for one of `names`, of which a table shows nothing, beside
/// --table.
void refuse_with_table(const CLI::App& app, std::initializer_list<const char*> names);

class Report {
   public:
    Report(const cli::Common& common, bool table, std::vector<Column> columns);

    /// One document: written at once, or kept as a row of the table.
    void add(Json document);

    /// Writes the table if there is one, and commits the output.
    void finish();

   private:
    io::Output output_;
    bool table_;
    std::vector<Column> columns_;
    std::vector<Json> rows_;
};

/// Calls document() for each document of the files in their order, standard input if there are none, and table() for each that is a
/// table (io::is_csv).
void for_each_input(const std::vector<std::string>& files, const std::function<void(io::Document)>& document,
                    const std::function<void(const std::string&)>& table);

/// What a subcommand does that makes one result of each document: adds --table and the common options to the app, parses, and
/// reports convert(document) for every document of the input. convert throws Error for a document that it cannot take; file and
/// document are put before its sentence. from_table: makes a document of a file that is a table (io::is_csv); without it such
/// a file is a stream like every other.
int report_each(CLI::App& app, int argc, char** argv, const std::vector<Column>& columns,
                const std::function<Json(io::Document)>& convert,
                const std::function<io::Document(const std::string&)>& from_table = {});

/// What a table shows in place of the error of a number whose interval of confidence tells nothing.
constexpr const char* not_determined = "not determined";

/// Whether it does: it reaches farther to either side than the value is large.
bool says_nothing(double value, double reach);

/// {edges, counts}.
Json histogram_json(const analysis::Histogram& histogram);

/// {mean, standard_deviation, minimum, maximum}; null for nothing.
Json spread_json(const std::optional<analysis::Spread>& spread);

/// The rows as text: headings with units, numbers with five digits, columns flush right, "-" for what a row does not have. Throws
/// Error for NaN and infinity, as JSON lines do.
std::string table_text(const std::vector<Column>& columns, const std::vector<Json>& rows);

}  // namespace kiln::analyze
