// report.cpp: JSON lines and aligned tables.
#include "tools/analyze/report.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include "io/csv.h"
#include "tools/common/each_state.h"

namespace kiln::analyze {

namespace {

constexpr std::array prefixes{Prefix{1e9, "G"},  Prefix{1e6, "M"},  Prefix{1e3, "k"},  Prefix{1.0, ""},
                              Prefix{1e-3, "m"}, Prefix{1e-6, "u"}, Prefix{1e-9, "n"}};

const Json& value_at(const Json& row, const std::string& key) {
    static const Json nothing;
    const auto found = row.find(key);
    return found == row.end() ? nothing : *found;
}

/// The prefix for the largest value of the column.
Prefix prefix_of_column(const Column& column, const std::vector<Json>& rows) {
    if (column.unit != "m" && column.unit != "Pa") return {1.0, ""};
    double largest = 0.0;
    for (const Json& row : rows)
        if (const Json& value = value_at(row, column.key); value.is_number())
            largest = std::max(largest, std::abs(value.get<double>()));
    return prefix_of(largest);
}

std::string cell(const Json& row, const std::string& key, double factor) {
    const Json& value = value_at(row, key);
    if (value.is_null()) return "-";
    if (value.is_string()) return value.get<std::string>();
    if (!value.is_number_float()) return value.dump();
    if (!std::isfinite(value.get<double>())) throw Error(key + " is not a finite number");
    char text[32];
    std::snprintf(text, sizeof text, "%.5g", value.get<double>() / factor);
    return text;
}

}  // namespace

Prefix prefix_of(double value) {
    if (value == 0.0) return {1.0, ""};
    const auto found = std::ranges::find_if(prefixes, [&](const Prefix& prefix) { return std::abs(value) >= prefix.factor; });
    return found == prefixes.end() ? prefixes.back() : *found;
}

void add_table(CLI::App& app, bool& table) {
    app.add_flag("--table", table, "A table for people, with units, instead of JSON");
}

void refuse_with_table(const CLI::App& app, std::initializer_list<const char*> names) {
    if (!app.get_option("--table")->as<bool>()) return;
    for (const char* name : names)
        if (app.count(name) > 0) throw CLI::ValidationError(name, "has no meaning with --table, which does not show it");
}

Report::Report(const cli::Common& common, bool table, std::vector<Column> columns)
    : output_(common.output, true), table_(table), columns_(std::move(columns)) {}

void Report::add(Json document) {
    if (table_)
        rows_.push_back(std::move(document));
    else
        output_.write(document);
}

void Report::finish() {
    if (table_) output_.write_text(table_text(columns_, rows_));
    output_.commit();
}

void for_each_input(const std::vector<std::string>& files, const std::function<void(io::Document)>& document,
                    const std::function<void(const std::string&)>& table) {
    std::vector<std::string> streams;  // between two tables
    const auto read_streams = [&] {
        io::Input input(std::exchange(streams, {}), cli::stop_requested);
        cli::for_each_document(input, document);
    };
    for (const std::string& file : files) {
        if (!io::is_csv(file)) {
            streams.push_back(file);
            continue;
        }
        if (!streams.empty()) read_streams();
        table(file);
    }
    if (!streams.empty() || files.empty()) read_streams();
}

int report_each(CLI::App& app, int argc, char** argv, const std::vector<Column>& columns,
                const std::function<Json(io::Document)>& convert,
                const std::function<io::Document(const std::string&)>& from_table) {
    cli::Common common;
    bool table = false;
    add_table(app, table);
    common.add_to(app, true, false);
    cli::parse(app, argc, argv, common);

    Report report(common, table, columns);
    const auto add = [&](io::Document document) { report.add(convert(std::move(document))); };
    if (from_table) {
        for_each_input(common.files, add, [&](const std::string& file) {
            io::Document test = from_table(file);
            cli::at_place(file, [&] { add(std::move(test)); });
        });
    } else {
        io::Input input(common.files, cli::stop_requested);
        cli::for_each_document(input, add);
    }
    report.finish();
    return cli::done;
}

bool says_nothing(double value, double reach) { return !(reach < std::abs(value)); }

Json histogram_json(const analysis::Histogram& histogram) {
    return {{"edges", histogram.edges}, {"counts", histogram.counts}};
}

Json spread_json(const std::optional<analysis::Spread>& spread) {
    if (!spread) return nullptr;
    return {{"mean", spread->mean},
            {"standard_deviation", spread->standard_deviation},
            {"minimum", spread->minimum},
            {"maximum", spread->maximum}};
}

std::string table_text(const std::vector<Column>& columns, const std::vector<Json>& rows) {
    std::vector<std::string> lines(rows.size() + 1);
    for (const Column& column : columns) {
        const Prefix prefix = prefix_of_column(column, rows);
        std::vector<std::string> cells{column.heading + (column.unit.empty() ? "" : ", " + (prefix.name + column.unit))};
        for (const Json& row : rows) cells.push_back(cell(row, column.key, prefix.factor));
        const std::size_t width = std::ranges::max(cells, {}, &std::string::size).size();
        for (std::size_t line = 0; line < lines.size(); ++line) {
            if (!lines[line].empty()) lines[line] += "  ";
            lines[line] += std::string(width - cells[line].size(), ' ') + cells[line];
        }
    }
    std::string text;
    for (const std::string& line : lines) text += line + "\n";
    return text;
}

}  // namespace kiln::analyze
