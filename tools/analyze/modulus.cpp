// modulus.cpp: Young's modulus from the last unloading of each bending test.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <span>

#include "tools/common/quantity_options.h"
#include "tools/common/value_options.h"
#include "io/state_io.h"
#include "physics/bending.h"
#include "tools/analyze/analyze.h"
#include "io/chart.h"
#include "analysis/line_fit.h"
#include "analysis/stiffness_bound.h"
#include "tools/analyze/measured_test.h"
#include "tools/analyze/report.h"
#include "tools/analyze/results.h"
#include "tools/analyze/table_material.h"
#include "analysis/student.h"
#include "analysis/unloading.h"

namespace kiln::analyze {

namespace {

constexpr const char* modulus_footer =
    "Reads dem-bend documents and tables of testing machines (FILE.csv, .txt, .tsv, .dat, .asc), writes dem-modulus documents. "
    "The "
    "slope S of force against deflection is that of the least squares line through the last unloading before the bar breaks, as "
    "far "
    "as its force lies in the window; E = S L^3/(4 b h^3) [1 + 2.4 (1 + nu) (h/L)^2]. A line that does not fit its points is "
    "refused.\n"
    "A table has units in its headings, such as 'deflection (mm),force (N)', 'Weg [um];Kraft [kN]', or in a row below them; a "
    "report "
    "above it, decimal commas, UTF-16 and Latin-1 are understood. Compression counted negative is turned. It requires --span, "
    "--width "
    "and --height, and --density if its modulus is to be fitted. With a dem-bend document they replace its own.\n\n"
    "Keys of a result:\n"
    "  young_modulus (Pa), relative_density, slope (N/m), compliance (m/N), window, points\n"
    "  standard_error       Pa; null for two points, and for simulated tests, whose curves do not scatter\n"
    "  confidence_interval  95 %, Student's t; null likewise\n"
    "  r_squared            share of the forces' variation that the line explains\n"
    "  branch               unloading or loading\n"
    "  slenderness          span over height, L/h\n"
    "  shear_correction     the bracket\n"
    "  poisson_ratio        in the bracket; null with --shear none\n"
    "  poisson_ratio_source  the option, the material or the test that it is from\n"
    "  warnings             sentences, those of the test too; of bars with L/h below 4,\n"
    "                       of E above what a body of that density can have\n"
    "  material             its name; null where neither the test nor --material says it\n"
    "  bond_law, method     of the test\n"
    "  columns, turned      of a table: the headings that were read {force, deflection}, and which had\n"
    "                       their signs turned\n"
    "  source               name of the table\n"
    "The error says how straight a measured curve is, not how much specimens differ; how much packings differ, several seeds say "
    "(analyze mean).\n\n"
    "Examples:\n"
    "  bend bonded.kiln | analyze modulus --table\n"
    "  analyze modulus --window 0.9:0.1 bent.json | analyze fit\n"
    "  analyze modulus --span 40mm --width 4mm --height 3mm --compliance 0.2um/N --density 0.79 bar7.csv\n"
    "  analyze modulus --span 40mm --width 4mm --height 3mm --branch loading --plot bar7.svg bar7.csv";

const std::vector<Column> modulus_columns{{"material", "material", ""},
                                          {"relative_density", "relative density", ""},
                                          {"young_modulus", "Young's modulus", "Pa"},
                                          {"standard_error", "standard error", "Pa"},
                                          {"slenderness", "L/h", ""},
                                          {"points", "points", ""},
                                          {"branch", "branch", ""},
                                          {"bond_law", "bond law", ""},
                                          {"method", "method", ""}};

constexpr double usual_poisson_ratio = 0.23;  // between 0.2 and 0.3 of oxides; of it E moves by 0.1 % of 0.1 at L/h = 13

struct ModulusOptions {
    analysis::Window window;
    BarOptions bar;
    std::optional<double> density, poisson_ratio;
    double compliance = 0.0;  // of machine and fixture, m/N
    bool shear = true;
    bool loading = false;
    ColumnOptions columns;
    TableMaterial material;
    std::string plot;  // a file; empty: none

    [[nodiscard]] std::string branch() const { return loading ? "loading" : "unloading"; }

    void add_to(CLI::App& app);
};

void ModulusOptions::add_to(CLI::App& app) {
    using io::Dimension;
    app.add_option_function<std::string>(
           "--window",
           [this](const std::string& text) { window = cli::parsed("--window", [&] { return analysis::parse_window(text); }); },
           "Force window of the branch, as fractions of its peak; the paper's 50 N and 20 N of 60 N are 5/6:1/3")
        ->type_name("UPPER:LOWER")
        ->default_str("5/6:1/3");
    cli::add_choice(app, "--branch", loading, {{"unloading", false}, {"loading", true}},
                    "Part of the test that the line goes through, the last of its kind before the bar breaks");
    bar.add_to(app);
    add_optional(app, "--density", density, Dimension::none, "Relative density of the specimen");
    add_optional(app, "--poisson-ratio", poisson_ratio, Dimension::none,
                 "Poisson's ratio in the shear correction (default: that of the test or of --material, else 0.23)");
    material.add_to(app, "its Poisson's ratio enters the shear correction");
    cli::add_quantity(app, "--compliance", compliance, Dimension::compliance,
                      "Deflection of machine and fixture per force, taken off the measured deflection", "0");
    cli::add_choice(app, "--shear", shear, {{"timoshenko", true}, {"none", false}},
                    "timoshenko: with the bracket; none: without it, as for a slender bar");
    columns.add_to(app);
    app.add_option("--plot", plot, "Also a picture of the curve of one test with the points and the line of the fit")
        ->type_name("FILE.svg");
    app.callback([this, &app] {
        if (!shear && app.count("--poisson-ratio") > 0)
            throw CLI::ValidationError("--poisson-ratio", "has no meaning with --shear none");
        if (!plot.empty()) cli::check_outputs({app.get_option("--output")->as<std::string>(), plot});
    });
}

/// The test of a table; warns where signs were turned.
io::Document test_from_table(const std::string& file, const ModulusOptions& options, bool quiet) {
    io::Document document = measured_test(io::CsvTable(file), file, options.columns, true);
    document.header["material"] = options.material.name();
    if (const auto& solid = options.material.material; solid && solid->poisson_ratio) {
        document.header["poisson_ratio"] = *solid->poisson_ratio;
        document.header["poisson_ratio_source"] = "material " + solid->name;
    } else {
        document.header["poisson_ratio"] = usual_poisson_ratio;
        document.header["poisson_ratio_source"] = "usual value, no material says it";
    }
    if (!quiet && !document.header["turned"].empty())
        cli::warn("analyze modulus", turned_sentence(document));
    return document;
}

/// The points of a branch in the window and the line through them.
struct BranchFit {
    analysis::Line line;
    std::vector<double> deflection, force;  // of the points, less what machine and fixture give way
    double peak;                            // N, largest force of the branch
};

/// Throws Error where the branch has too few points or no straight line.
BranchFit fit_branch(const Curve& curve, const ModulusOptions& options, bool measured) {
    const auto last = analysis::point_before_break(curve.punch, curve.force);
    const std::size_t whole = last ? *last + 1 : curve.force.size();
    const auto travel = std::span(curve.punch).first(whole), force = std::span(curve.force).first(whole);
    const auto branch = options.loading ? analysis::last_loading(travel, force) : analysis::last_unloading(travel);
    if (!branch)
        throw Error("the curve has no " + options.branch() + (last ? " before the bar breaks" : "") +
                    (options.loading ? "" : "; --branch loading takes the slope of its rise"));
    BranchFit fit;
    fit.peak = std::ranges::max(force.subspan(branch->first, branch->last - branch->first + 1));
    for (const std::size_t point : analysis::points_in(force, *branch, options.window)) {
        fit.deflection.push_back(curve.deflection[point] - options.compliance * force[point]);
        fit.force.push_back(force[point]);
    }
    const std::string where = "the last " + options.branch();
    const std::size_t required = measured ? 3 : 2;
    if (fit.force.size() < required)
        throw Error(where + " has " + std::to_string(fit.force.size()) + " points in the window of forces, expected " +
                    (measured ? "three" : "two") + " or more; give a wider --window");
    const auto [least, most] = std::ranges::minmax(fit.force);
    if (measured && most - least < 0.5 * (options.window.upper - options.window.lower) * fit.peak)
        throw Error("the points of " + where + " lie in less than half of the window of forces; give another --window");
    fit.line = analysis::fit_line(fit.deflection, fit.force);
    if (const auto problem = analysis::misfit(fit.line, fit.deflection, fit.force))
        throw Error(*problem + " in " + where + (options.compliance > 0.0 ? ", less --compliance" : "") +
                    (fit.line.slope > 0.0 ? "; give another --window or --branch" : ""));
    return fit;
}

/// "203.3 GPa".
std::string modulus_text(double modulus) {
    const Prefix prefix = prefix_of(modulus);
    char text[64];
    std::snprintf(text, sizeof text, "E = %.4g %sPa", modulus / prefix.factor, prefix.name);
    return text;
}

/// The curve, the points of the fit and the line, from no force to the largest of the branch.
io::Chart chart_of(const Curve& curve, const BranchFit& fit, const ModulusOptions& options, const std::string& title) {
    const Prefix length = prefix_of(std::ranges::max(curve.deflection)), force = prefix_of(std::ranges::max(curve.force));
    const auto scaled = [](std::vector<double> values, double factor) {
        for (double& value : values) value /= factor;
        return values;
    };
    std::vector<double> deflection = curve.deflection;
    for (std::size_t point = 0; point < deflection.size(); ++point) deflection[point] -= options.compliance * curve.force[point];
    const std::vector<double> ends{0.0, fit.peak};
    const std::vector<double> along{-fit.line.intercept / fit.line.slope, (fit.peak - fit.line.intercept) / fit.line.slope};
    return {title,
            std::string("Deflection, ") + length.name + "m" + (options.compliance > 0.0 ? ", less --compliance" : ""),
            std::string("Force, ") + force.name + "N",
            {{"test", io::chart_grey, false, scaled(deflection, length.factor), scaled(curve.force, force.factor)},
             {"points of the fit", io::chart_blue, true, scaled(fit.deflection, length.factor), scaled(fit.force, force.factor)},
             {"line", io::chart_red, false, scaled(along, length.factor), scaled(ends, force.factor)}},
            {},
            {}};
}

/// Poisson's ratio of the shear correction and where it is from: the option's, else the document's, which need not have one.
std::pair<double, std::string> poisson_ratio_of(const io::Document& document, const ModulusOptions& options) {
    if (options.poisson_ratio) return {*options.poisson_ratio, "--poisson-ratio"};
    if (!document.header.contains("poisson_ratio"))
        throw Error("has no poisson_ratio, which the shear correction requires; give --poisson-ratio or --shear none");
    const Json source = document.header.value("poisson_ratio_source", Json("the test"));
    return {number_at(document, "poisson_ratio", -1.0), source.is_string() ? source.get<std::string>() : "the test"};
}

/// Standard error of the slope. That of a simulated test is null: its curve has no scatter, and what the line leaves over is the
/// solver's rounding and the curvature of its contacts.
Json slope_error(const BranchFit& fit, bool measured) {
    return measured && std::isfinite(fit.line.slope_error) ? Json(fit.line.slope_error) : Json();
}

/// That E is above what the solid of a simulated test allows.
std::optional<std::string> bound_warning(const io::Document& document, double modulus) {
    for (const char* key : {"young_modulus", "poisson_ratio", "relative_density"})
        if (!document.header.contains(key)) return std::nullopt;
    const physics::IsotropicModuli solid =
        physics::isotropic_moduli(positive_at(document, "young_modulus"), number_at(document, "poisson_ratio", -1.0));
    return analysis::above_bound_warning(modulus, solid, positive_at(document, "relative_density"));
}

/// The sentences of the test, and those on what it gives, which are said at once.
Json warnings_of(const io::Document& document, const ModulusOptions& options, double modulus, double correction, bool quiet) {
    std::vector<std::string> list = options.bar.warnings(document);
    for (const auto& sentence : {options.bar.short_bar_warning(document, correction), bound_warning(document, modulus)}) {
        if (!sentence) continue;
        list.push_back(*sentence);
        if (!quiet) cli::warn("analyze modulus", document.place + ": " + *sentence);
    }
    return list;
}

/// The result of a test; the picture of it into `plot` if one is asked for.
Json modulus_of(const io::Document& document, const ModulusOptions& options, bool quiet, std::string& plot) {
    expect_format(document, {"dem-bend"}, "modulus");
    if (!is_measured(document)) {
        options.columns.refuse_with_documents();
        options.material.refuse_with_documents();
    }
    const double span = options.bar.size(document, "span");
    const double width = options.bar.size(document, "width"), height = options.bar.size(document, "height");
    options.bar.refuse_block(document);
    Json density = options.density ? Json(*options.density) : Json();
    if (!options.density && !is_measured(document)) density = positive_at(document, "relative_density");
    const Curve curve = curve_of(document);
    const BranchFit fit = fit_branch(curve, options, is_measured(document));
    Json poisson_ratio, poisson_source;
    double correction = 1.0;
    if (options.shear) {
        const auto [ratio, from] = poisson_ratio_of(document, options);
        correction = physics::shear_correction(height, span, ratio);
        poisson_ratio = ratio;
        poisson_source = from;
    }
    const double factor = physics::slender_modulus(1.0, span, width, height) * correction;
    const double modulus = factor * fit.line.slope;
    Json error = slope_error(fit, is_measured(document)), interval;
    if (!error.is_null()) {
        error = factor * error.get<double>();
        const double reach = analysis::student_factor(fit.force.size() - 2, confidence) * error.get<double>();
        interval = {modulus - reach, modulus + reach};
    }
    const std::string source = std::filesystem::path(document.place).filename().string();
    Json result{{"format", "dem-modulus"},
                {"version", io::format_version},
                {"material", document.header.value("material", Json())},
                {"young_modulus", modulus},
                {"standard_error", error},
                {"confidence_interval", interval},
                {"slope", fit.line.slope},
                {"relative_density", density},
                {"slenderness", span / height},
                {"shear_correction", correction},
                {"poisson_ratio", poisson_ratio},
                {"poisson_ratio_source", poisson_source},
                {"compliance", options.compliance},
                {"window", {options.window.upper, options.window.lower}},
                {"points", fit.force.size()},
                {"r_squared", fit.line.r_squared},
                {"branch", options.branch()},
                {"warnings", warnings_of(document, options, modulus, correction, quiet)}};
    if (is_measured(document)) result["source"] = source;
    for (const char* key : {"bond_law", "method", "columns", "turned", "history"})
        if (document.header.contains(key)) result[key] = document.header[key];
    if (!options.plot.empty()) {
        if (!plot.empty()) throw Error("--plot shows one test, and this is the second");
        plot = io::svg_of(chart_of(curve, fit, options, source + ": last " + options.branch() + ", " + modulus_text(modulus)));
    }
    return result;
}

}  // namespace

int modulus(int argc, char** argv) {
    ModulusOptions options;
    CLI::App app{"Young's modulus from the force and deflection of three-point bending tests.", "analyze modulus"};
    app.footer(modulus_footer);
    options.add_to(app);
    std::string plot;
    const auto convert = [&](const io::Document& document) {
        Json result = modulus_of(document, options, app.get_option("--quiet")->as<bool>(), plot);
        if (result.contains("history")) result["history"].push_back(cli::history_entry("analyze modulus", app, Json::object()));
        return result;
    };
    const int status = report_each(app, argc, argv, modulus_columns, convert, [&](const std::string& file) {
        return test_from_table(file, options, app.get_option("--quiet")->as<bool>());
    });
    write_plot(options.plot, plot);
    return status;
}

}  // namespace kiln::analyze
