// strength.cpp: bending strength of bars that broke, and Weibull's distribution of those of several.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <span>

#include "analysis/histogram.h"
#include "analysis/unloading.h"
#include "analysis/weibull.h"
#include "io/chart.h"
#include "io/csv.h"
#include "io/state_io.h"
#include "physics/bending.h"
#include "tools/analyze/analyze.h"
#include "tools/analyze/measured_test.h"
#include "tools/analyze/report.h"
#include "tools/analyze/results.h"
#include "tools/analyze/table_material.h"
#include "tools/common/each_state.h"

namespace kiln::analyze {

namespace {

constexpr std::size_t min_bars = 5;  // of Weibull's parameters, as in ASTM C1239

constexpr const char* strength_footer =
    "Reads dem-bend documents of tests to failure (bend --tensile-strength) and tables (FILE.csv, .txt, .tsv, .dat, .asc), all of "
    "them for one result. A table is a test of one bar, 'deflection (mm),force (N)', whose largest force counts; or has a row for "
    "each bar: 'strength (MPa)', or 'force (N),width (mm),height (mm)'. The strength is 3 F L/(2 b h^2) after ASTM C1161, with "
    "--inner-span Li for two points of load 3 F (L - Li)/(2 b h^2). Tables require --span, and --width and --height where they "
    "are "
    "no columns.\n\n"
    "Keys of a result:\n"
    "  material                  names in one text; null where nothing says it\n"
    "  bars                      their number\n"
    "  strengths                 of each {strength (Pa), source, material, peak_force (N),\n"
    "                            relative_density}, and of a table {columns, turned} {force, deflection},\n"
    "                            {fall_recorded}: whether the force falls after its largest\n"
    "  mean_strength, standard_deviation  Pa; the deviation is null for one bar\n"
    "  weibull_modulus           of the greatest likelihood; null for fewer than 5 bars, as what follows\n"
    "  unbiased_weibull_modulus, unbiasing_factor\n"
    "                            the modulus times the factor: right on the average of many such samples\n"
    "  characteristic_strength   Pa; 63.2 % of all bars break below it\n"
    "  confidence_intervals      95 %, of both parameters\n"
    "  warnings                  sentences, those of the tests too; of bars with L/h below 4\n"
    "Factor and intervals are those of ASTM C1239 (Thoman, Bain and Antle 1969), by the same way of drawing samples of so many "
    "bars; "
    "the factor is 0.955 for 30 bars in that table and 0.953 here.\n\n"
    "Examples:\n"
    "  analyze strength --span 40mm --width 4mm --height 3mm --table broken.csv\n"
    "  analyze strength --span 40mm --inner-span 20mm bars.csv  # force (N),width (mm),height (mm)\n"
    "  analyze strength --plot weibull.svg strengths.csv  # strength (MPa)\n"
    "  bend --tensile-strength 500MPa bonded.kiln | analyze strength --table";

const std::vector<Column> strength_columns{{"material", "material", ""},
                                           {"bars", "bars", ""},
                                           {"mean_strength", "mean strength", "Pa"},
                                           {"standard_deviation", "standard deviation", "Pa"},
                                           {"weibull_modulus", "Weibull modulus", ""},
                                           {"lower_modulus", "from", ""},
                                           {"upper_modulus", "to", ""},
                                           {"unbiased_weibull_modulus", "unbiased", ""},
                                           {"characteristic_strength", "characteristic strength", "Pa"},
                                           {"lower_strength", "from", "Pa"},
                                           {"upper_strength", "to", "Pa"}};

const io::ColumnNames strength_names{"strength",           "bending strength", "bending_strength", "flexural strength",
                                     "modulus of rupture", "mor",              "biegefestigkeit",  "festigkeit"};
const io::ColumnNames width_names{"width", "breite", "b$"}, height_names{"height", "thickness", "h\u00f6he", "dicke", "h$", "d$"};

struct StrengthOptions {
    BarOptions bar;
    std::optional<double> inner_span;  // m
    ColumnOptions columns;
    TableMaterial material;
    std::string plot;  // a file; empty: none
    bool table = false;

    void add_to(CLI::App& app);
};

void StrengthOptions::add_to(CLI::App& app) {
    bar.add_to(app);
    add_optional(app, "--inner-span", inner_span, io::Dimension::length,
                 "Distance between two points of load, as in a test at four points (default: one point)");
    columns.add_to(app);
    material.add_to(app, "its name stands in the result");
    app.add_option("--plot", plot, "Also a picture: the share of broken bars against their strength on Weibull's axes")
        ->type_name("FILE.svg");
    add_table(app, table);
    app.callback([this, &app] {
        if (inner_span && bar.span && *inner_span >= *bar.span)
            throw CLI::ValidationError("--inner-span", "is not shorter than --span");
        if (!plot.empty()) cli::check_outputs({app.get_option("--output")->as<std::string>(), plot});
    });
}

/// What becomes of the input: an entry for each bar.
class Bars {
   public:
    Bars(const StrengthOptions& options, bool quiet) : options_(options), quiet_(quiet) {}

    /// A dem-bend document of a bar that broke.
    void add(const io::Document& document) {
        expect_format(document, {"dem-bend"}, "strength");
        if (is_measured(document)) return add_test(document);
        options_.columns.refuse_with_documents();
        options_.material.refuse_with_documents();
        material_ = document.header.value("material", Json());
        if (options_.inner_span) throw Error("is a test with one point of load, for which --inner-span has no meaning");
        if (!document.header.contains("strength") || !document.header["strength"].is_object())
            throw Error("was not bent until it broke, as bend --tensile-strength does");
        io::Document found;
        found.header = document.header["strength"];
        if (positive_at(found, "breaks") < 1.0) throw Error("no bond of the bar broke");
        const double force = positive_at(found, "peak_force");
        check_slenderness(document);
        add_bar(force, size(document, "span"), size(document, "width"), size(document, "height"), source_of(document.place));
        if (document.header.contains("relative_density")) bars_.back()["relative_density"] = document.header["relative_density"];
    }

    /// A table of one test, or of several bars.
    void add_table(const std::string& file) {
        using io::Dimension;
        const io::CsvTable table(file);
        material_ = options_.material.name();
        const bool chosen = !options_.columns.force.empty();
        if (const auto column = chosen ? std::nullopt : table.find(strength_names, Dimension::pressure)) {
            const std::vector<double> strengths = table.values(*column, Dimension::pressure);
            for (std::size_t row = 0; row < strengths.size(); ++row) add_strength(strengths[row], table.place(row));
            return;
        }
        const auto width = table.column(width_names, Dimension::length), height = table.column(height_names, Dimension::length);
        if (width || height) return add_rows(table, file, width, height);
        cli::at_place(file, [&] { add_test(measured_test(table, file, options_.columns, true)); });
    }

    [[nodiscard]] const std::vector<Json>& bars() const { return bars_; }
    [[nodiscard]] const std::vector<double>& strengths() const { return strengths_; }
    [[nodiscard]] const Json& warnings() const { return warnings_; }

    /// The names of the materials of all bars in one text; null where no bar says it.
    [[nodiscard]] Json material() const { return joined_materials(bars_); }

   private:
    static std::string source_of(const std::string& place) { return std::filesystem::path(place).filename().string(); }

    double size(const io::Document& document, const std::string& key) const { return options_.bar.size(document, key); }

    void warn(const std::string& sentence) const {
        if (!quiet_) cli::warn("analyze strength", sentence);
    }

    /// Refuses blocks; keeps what the test warns of, and warns of short bars where it does not.
    void check_slenderness(const io::Document& document) {
        options_.bar.refuse_block(document);
        for (const std::string& sentence : options_.bar.warnings(document))
            warnings_.push_back(source_of(document.place) + ": " + sentence);
        if (const auto sentence = options_.bar.short_bar_warning(document, std::nullopt)) {
            warn(document.place + ": " + *sentence);
            warnings_.push_back(source_of(document.place) + ": " + *sentence);
        }
    }

    /// A row a bar; a size that is no column is the option's.
    void add_rows(const io::CsvTable& table, const std::string& file, const std::optional<std::vector<double>>& width,
                  const std::optional<std::vector<double>>& height) {
        const io::ColumnChoice choice{"--force-column", options_.columns.force};
        const std::vector<double> force = table.values(table.get(force_names, io::Dimension::force, choice), io::Dimension::force);
        io::Document sizes;
        sizes.header = {{"method", "experiment"}};
        cli::at_place(file, [&] {
            const double span = size(sizes, "span");
            for (std::size_t row = 0; row < force.size(); ++row) {
                const double b = width ? (*width)[row] : size(sizes, "width"), h = height ? (*height)[row] : size(sizes, "height");
                if (!(b > 0.0 && h > 0.0)) throw io::PlacedError(table.place(row) + ": a width or height is not above zero");
                sizes.place = table.place(row);
                sizes.header["height"] = h;
                cli::at_place(sizes.place, [&] { check_slenderness(sizes); });
                add_bar(std::abs(force[row]), span, b, h, source_of(table.place(row)));
            }
        });
    }

    /// A measured curve: its largest force, if the bar broke there.
    void add_test(const io::Document& document) {
        const Curve curve = curve_of(document);
        const double peak = std::ranges::max(curve.force);
        const bool broke = analysis::point_before_break(curve.punch, curve.force).has_value();
        if (!broke && curve.force.back() < 0.5 * peak) throw Error("the bar was unloaded and did not break");
        if (!broke) warn(document.place + ": the record ends under load; the bar is taken to break at its largest force");
        if (!document.header["turned"].empty()) warn(turned_sentence(document));
        check_slenderness(document);
        add_bar(peak, size(document, "span"), size(document, "width"), size(document, "height"), source_of(document.place));
        for (const char* key : {"columns", "turned"}) bars_.back()[key] = document.header[key];
        bars_.back()["fall_recorded"] = broke;
    }

    void add_bar(double force, double span, double width, double height, const std::string& source) {
        const double inner = options_.inner_span.value_or(0.0);
        if (inner >= span) throw Error("--inner-span is not shorter than the span");
        add_strength(physics::bending_strength(force, span, width, height, inner), source);
        bars_.back()["peak_force"] = force;
    }

    void add_strength(double strength, const std::string& source) {
        if (!(strength > 0.0)) throw io::PlacedError(source + ": the strength is not above zero");
        strengths_.push_back(strength);
        bars_.push_back({{"strength", strength}, {"source", source}, {"material", material_}});
    }

    const StrengthOptions& options_;
    bool quiet_;
    Json warnings_ = Json::array(), material_;
    std::vector<Json> bars_;
    std::vector<double> strengths_;
};

Json strength_result(const Bars& bars) {
    const std::span<const double> strengths = bars.strengths();
    const auto spread = analysis::spread_of(strengths);
    const auto count = static_cast<double>(strengths.size());
    const double of_sample = std::sqrt(count / (count - 1.0));
    Json result{{"format", "dem-strength"},
                {"version", io::format_version},
                {"material", bars.material()},
                {"bars", strengths.size()},
                {"strengths", bars.bars()},
                {"mean_strength", spread->mean},
                {"standard_deviation", strengths.size() > 1 ? Json(spread->standard_deviation * of_sample) : Json()},
                {"warnings", bars.warnings()}};
    for (const char* key : {"weibull_modulus", "unbiased_weibull_modulus", "unbiasing_factor", "characteristic_strength",
                            "confidence_intervals"})
        result[key] = nullptr;
    if (strengths.size() < min_bars) return result;
    const analysis::Weibull found = analysis::fit_weibull(strengths);
    const analysis::WeibullScatter scatter = analysis::weibull_scatter(strengths.size(), confidence);
    const auto strength_at = [&](double shift) { return found.characteristic_strength * std::exp(-shift / found.modulus); };
    result["weibull_modulus"] = found.modulus;
    result["unbiased_weibull_modulus"] = scatter.unbiasing * found.modulus;
    result["unbiasing_factor"] = scatter.unbiasing;
    result["characteristic_strength"] = found.characteristic_strength;
    result["confidence_intervals"] = {
        {"weibull_modulus", {found.modulus / scatter.upper_modulus, found.modulus / scatter.lower_modulus}},
        {"characteristic_strength", {strength_at(scatter.upper_strength), strength_at(scatter.lower_strength)}}};
    return result;
}

/// ln ln 1/(1 - F) against the logarithm of the strength, where Weibull's distribution is a line; the bar i of N stands at
/// F = (i - 0.5)/N (ASTM C1239).
io::Chart weibull_chart(std::vector<double> strengths, const Json& result) {
    std::ranges::sort(strengths);
    const Prefix prefix = prefix_of(strengths.back());
    io::ChartSeries points{"bars", io::chart_blue, true, {}, {}}, line{"greatest likelihood", io::chart_red, false, {}, {}};
    const auto height_of = [](double share) { return std::log(-std::log(1.0 - share)); };
    for (std::size_t bar = 0; bar < strengths.size(); ++bar) {
        points.x.push_back(std::log(strengths[bar] / prefix.factor));
        points.y.push_back(height_of((static_cast<double>(bar) + 0.5) / static_cast<double>(strengths.size())));
    }
    const double modulus = result["weibull_modulus"].get<double>();
    const double middle = std::log(result["characteristic_strength"].get<double>() / prefix.factor);
    for (const double y : {points.y.front(), points.y.back()}) {
        line.x.push_back(middle + y / modulus);
        line.y.push_back(y);
    }
    std::vector<io::ChartTick> across = io::round_ticks(strengths.front() / prefix.factor, strengths.back() / prefix.factor), up;
    for (io::ChartTick& tick : across) tick.at = std::log(tick.at);
    for (const int percent : {1, 2, 5, 10, 20, 40, 63, 80, 90, 99})
        up.push_back({height_of(0.01 * percent), std::to_string(percent)});
    char title[128];
    std::snprintf(title, sizeof title, "%zu bars: Weibull modulus %.3g, characteristic strength %.4g %sPa", strengths.size(),
                  modulus, result["characteristic_strength"].get<double>() / prefix.factor, prefix.name);
    return {title, std::string("Strength, ") + prefix.name + "Pa", "Broken bars, %", {points, line}, across, up};
}

/// The result with what the table shows at its top level.
Json flat(Json result) {
    const Json intervals = result["confidence_intervals"];
    if (intervals.is_null()) return result;
    for (const int side : {0, 1}) {
        result[side == 0 ? "lower_modulus" : "upper_modulus"] = intervals["weibull_modulus"][static_cast<std::size_t>(side)];
        result[side == 0 ? "lower_strength" : "upper_strength"] =
            intervals["characteristic_strength"][static_cast<std::size_t>(side)];
    }
    return result;
}

}  // namespace

int strength(int argc, char** argv) {
    cli::Common common;
    StrengthOptions options;
    CLI::App app{"Bending strength of bars that broke, and Weibull's distribution of several.", "analyze strength"};
    app.footer(strength_footer);
    options.add_to(app);
    common.add_to(app, true, false);
    cli::parse(app, argc, argv, common);

    Bars bars(options, common.quiet);
    for_each_input(common.files, [&](const io::Document& document) { bars.add(document); },
                   [&](const std::string& file) { bars.add_table(file); });
    const Json result = strength_result(bars);
    const bool several = !result["weibull_modulus"].is_null();
    if (!several && !common.quiet)
        cli::warn("analyze strength", "Weibull's parameters need 5 bars or more, these are " + std::to_string(bars.bars().size()));
    if (!options.plot.empty() && !several) throw Error("--plot needs 5 bars or more");
    Report report(common, options.table, strength_columns);
    report.add(options.table ? flat(result) : result);
    report.finish();
    if (!options.plot.empty()) write_plot(options.plot, io::svg_of(weibull_chart(bars.strengths(), result)));
    return cli::done;
}

}  // namespace kiln::analyze
