// modulus.cpp: Young's modulus from the last unloading of each bending test.
#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>

#include "tools/common/quantity_options.h"
#include "tools/common/value_options.h"
#include "io/state_io.h"
#include "physics/bending.h"
#include "tools/analyze/analyze.h"
#include "io/csv.h"
#include "analysis/line_fit.h"
#include "tools/analyze/report.h"
#include "tools/analyze/results.h"
#include "analysis/student.h"
#include "analysis/unloading.h"

namespace kiln::analyze {

namespace {

constexpr const char* modulus_footer =
    "Reads dem-bend documents and files FILE.csv of experiments, writes dem-modulus documents. The slope S of force against "
    "deflection is that of the least squares line through the last unloading, as far as its force lies in the window; "
    "E = S L^3/(4 b h^3) [1 + 2.4 (1 + nu) (h/L)^2].\n"
    "A CSV has a heading with units, such as 'deflection (mm),force (N)' (also displacement, and punch for the travel of the "
    "machine); it requires --span, --width and --height, and --density if its modulus is to be fitted. With a dem-bend document "
    "they replace its own.\n\n"
    "Keys of a result:\n"
    "  young_modulus (Pa), relative_density, slope (N/m), compliance (m/N), window, points\n"
    "  standard_error       Pa; null for two points\n"
    "  confidence_interval  95 %, Student's t; null for two points\n"
    "  shear_correction     the bracket\n"
    "  bond_law, method     of the test\n"
    "The error says how straight the curve is, not how much packings or specimens differ.\n\n"
    "Examples:\n"
    "  bend bonded.kiln | analyze modulus --table\n"
    "  analyze modulus --window 0.9:0.1 bent.json | analyze fit\n"
    "  analyze modulus --span 40mm --width 4mm --height 3mm --compliance 0.2um/N --density 0.79 bar7.csv";


const std::vector<Column> modulus_columns{{"relative_density", "relative density", ""}, {"young_modulus", "Young's modulus", "Pa"},
                                  {"standard_error", "standard error", "Pa"},   {"points", "points", ""},
                                  {"bond_law", "bond law", ""},                 {"method", "method", ""}};

struct ModulusOptions {
    analysis::Window window;
    std::optional<double> span, width, height;  // m
    std::optional<double> density, poisson_ratio;
    double compliance = 0.0;  // of machine and fixture, m/N
    bool shear = true;

    void add_to(CLI::App& app);
};

/// An option that stays empty unless it is given, and must be positive then.
void add_optional(CLI::App& app, const std::string& name, std::optional<double>& target, io::Dimension dimension,
                  const std::string& help) {
    const std::string known = io::known_units(dimension);
    app.add_option_function<std::string>(
           name,
           [&target, name, dimension](const std::string& text) {
               target = cli::parsed(name, [&] { return io::parse_quantity(text, dimension); });
               if (!(*target > 0.0)) throw CLI::ValidationError(name, "must be greater than zero");
           },
           help + (known.empty() ? "" : " [" + known + "]"))
        ->type_name(known.empty() ? "NUMBER" : "QUANTITY");
}

void ModulusOptions::add_to(CLI::App& app) {
    using io::Dimension;
    app.add_option_function<std::string>(
           "--window",
           [this](const std::string& text) { window = cli::parsed("--window", [&] { return analysis::parse_window(text); }); },
           "Force window of the unloading, as fractions of its peak; the paper's 50 N and 20 N of 60 N are 5/6:1/3")
        ->type_name("UPPER:LOWER")
        ->default_str("5/6:1/3");
    add_optional(app, "--span", span, Dimension::length, "Distance between the supports");
    add_optional(app, "--width", width, Dimension::length, "Width of the bar");
    add_optional(app, "--height", height, Dimension::length, "Height of the bar, along the load");
    add_optional(app, "--density", density, Dimension::none, "Relative density of the specimen");
    add_optional(app, "--poisson-ratio", poisson_ratio, Dimension::none,
                 "Poisson's ratio in the shear correction (default 0.23 for a CSV)");
    cli::add_quantity(app, "--compliance", compliance, Dimension::compliance,
                      "Deflection of machine and fixture per force, taken off the measured deflection", "0");
    cli::add_choice(app, "--shear", shear, {{"timoshenko", true}, {"none", false}},
                    "timoshenko: with the bracket; none: without it, as for a slender bar");
    app.callback([this, &app] {
        if (!shear && app.count("--poisson-ratio") > 0)
            throw CLI::ValidationError("--poisson-ratio", "has no meaning with --shear none");
    });
}

/// The CSV of an experiment as the document that bend would have written.
io::Document test_from_csv(const std::string& file, const ModulusOptions& options) {
    const io::CsvTable table(file);
    io::Document document;
    document.place = file;
    const auto deflection = table.required({"deflection", "displacement", "durchbiegung"}, io::Dimension::length);
    const auto punch = table.column({"punch", "travel", "crosshead"}, io::Dimension::length);
    document.header = {{"format", "dem-bend"},
                       {"method", "experiment"},
                       {"poisson_ratio", options.poisson_ratio.value_or(0.23)},  // alumina
                       {"curve",
                        {{"deflection", deflection},
                         {"punch", punch ? *punch : deflection},
                         {"force", table.required({"force", "load", "kraft"}, io::Dimension::force)}}}};
    return document;
}

struct Curve {
    std::vector<double> deflection;  // m
    std::vector<double> punch;       // m
    std::vector<double> force;       // N
};

Curve curve_of(const io::Document& document) {
    Curve curve{numbers_at(document, "curve", "deflection"), numbers_at(document, "curve", "punch"),
                numbers_at(document, "curve", "force")};
    const std::size_t points = curve.force.size();
    if (curve.deflection.size() != points || curve.punch.size() != points)
        throw Error("curve has " + std::to_string(curve.deflection.size()) + " deflections, " +
                    std::to_string(curve.punch.size()) + " punch positions and " + std::to_string(points) + " forces");
    return curve;
}

/// Force against deflection in the window of the last unloading, and how many points that are.
std::pair<analysis::Line, std::size_t> unloading_line(const Curve& curve, const ModulusOptions& options) {
    const auto branch = analysis::last_unloading(curve.punch);
    if (!branch) throw Error("the curve has no unloading");
    std::vector<double> deflection, force;
    for (const std::size_t point : analysis::points_in(curve.force, *branch, options.window)) {
        deflection.push_back(curve.deflection[point] - options.compliance * curve.force[point]);
        force.push_back(curve.force[point]);
    }
    if (force.size() < 2)
        throw Error("the last unloading has " + std::to_string(force.size()) +
                    " points in the window of forces, expected two or more; give a wider --window");
    const analysis::Line line = analysis::fit_line(deflection, force);
    if (!(line.slope > 0.0) || !std::isfinite(line.slope))
        throw Error(std::string("the force does not grow with the deflection in the last unloading") +
                    (options.compliance > 0.0 ? ", less --compliance" : ""));
    return {line, force.size()};
}

/// A size of the specimen: the option's, else the document's.
double size_of(const io::Document& document, const std::string& key, const std::optional<double>& given) {
    if (given) return *given;
    if (io::is_csv(document.place) && !document.header.contains(key))
        throw Error("--" + key + " is needed with a CSV");
    return positive_at(document, key);
}

/// Poisson's ratio of the shear correction: the option's, else the document's, which need not have one.
double poisson_ratio_of(const io::Document& document, const ModulusOptions& options) {
    if (options.poisson_ratio) return *options.poisson_ratio;
    if (!document.header.contains("poisson_ratio"))
        throw Error("has no poisson_ratio, which the shear correction requires; give --poisson-ratio or --shear none");
    return number_at(document, "poisson_ratio", -1.0);
}

Json modulus_of(const io::Document& document, const ModulusOptions& options) {
    expect_format(document, {"dem-bend"}, "modulus");
    const double span = size_of(document, "span", options.span);
    const double width = size_of(document, "width", options.width), height = size_of(document, "height", options.height);
    Json density = options.density ? Json(*options.density) : Json();
    if (!options.density && !io::is_csv(document.place)) density = positive_at(document, "relative_density");
    const auto [line, points] = unloading_line(curve_of(document), options);
    const double correction = options.shear ? physics::shear_correction(height, span, poisson_ratio_of(document, options)) : 1.0;
    const double factor = physics::slender_modulus(1.0, span, width, height) * correction;
    const double modulus = factor * line.slope, error = factor * line.slope_error;
    Json interval;
    if (std::isfinite(error)) {
        const double reach = analysis::student_factor(points - 2, confidence) * error;
        interval = {modulus - reach, modulus + reach};
    }
    Json result{{"format", "dem-modulus"},
                {"version", io::format_version},
                {"young_modulus", modulus},
                {"standard_error", std::isfinite(error) ? Json(error) : Json()},
                {"confidence_interval", interval},
                {"slope", line.slope},
                {"relative_density", density},
                {"shear_correction", correction},
                {"compliance", options.compliance},
                {"window", {options.window.upper, options.window.lower}},
                {"points", points}};
    if (io::is_csv(document.place)) result["source"] = std::filesystem::path(document.place).filename().string();
    for (const char* key : {"bond_law", "method", "history"})
        if (document.header.contains(key)) result[key] = document.header[key];
    return result;
}

}  // namespace

int modulus(int argc, char** argv) {
    ModulusOptions options;
    CLI::App app{"Young's modulus from the force and deflection of three-point bending tests.", "analyze modulus"};
    app.footer(modulus_footer);
    options.add_to(app);
    const auto convert = [&](const io::Document& document) {
        Json result = modulus_of(document, options);
        if (result.contains("history")) result["history"].push_back(cli::history_entry("analyze modulus", app, Json::object()));
        return result;
    };
    return report_each(app, argc, argv, modulus_columns, convert,
                       [&](const std::string& file) { return test_from_csv(file, options); });
}

}  // namespace kiln::analyze
