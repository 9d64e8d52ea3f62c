// modulus.cpp: Young's modulus from the last unloading of each bending test.
#include <cmath>

#include "io/state_io.h"
#include "physics/bending.h"
#include "tools/analyze/analyze.h"
#include "tools/analyze/line_fit.h"
#include "tools/analyze/report.h"
#include "tools/analyze/results.h"
#include "tools/analyze/unloading.h"

namespace kiln::analyze {

namespace {

constexpr const char* footer =
    "Reads dem-bend documents, writes dem-modulus documents. The slope S of force against deflection is that of the least squares "
    "line through the last unloading, as far as its force lies in the window; E = S L^3/(4 b h^3) [1 + 2.4 (1 + nu) (h/L)^2].\n"
    "Keys: young_modulus (Pa), standard_error (Pa; null for two points), slope (N/m), relative_density, shear_correction (the "
    "bracket), window, points, and bond_law and method of the test. The error says how straight the curve is, not how much "
    "packings differ.\n"
    "Examples:\n"
    "  bend bonded.kiln | analyze modulus --table\n"
    "  analyze modulus --window 0.9:0.1 tests.json | analyze fit";

const std::vector<Column> columns{{"relative_density", "relative density", ""}, {"young_modulus", "Young's modulus", "Pa"},
                                  {"standard_error", "standard error", "Pa"},   {"points", "points", ""},
                                  {"bond_law", "bond law", ""},                 {"method", "method", ""}};

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
        throw Error(document.place + ": curve has " + std::to_string(curve.deflection.size()) + " deflections, " +
                    std::to_string(curve.punch.size()) + " punch positions and " + std::to_string(points) + " forces");
    return curve;
}

/// Force against deflection in the window of the last unloading, and how many points that are.
std::pair<Line, std::size_t> unloading_line(const Curve& curve, const Window& window, const std::string& place) {
    const auto branch = last_unloading(curve.punch);
    if (!branch) throw Error(place + ": the curve has no unloading");
    std::vector<double> deflection, force;
    for (const std::size_t point : points_in(curve.force, *branch, window)) {
        deflection.push_back(curve.deflection[point]);
        force.push_back(curve.force[point]);
    }
    if (force.size() < 2)
        throw Error(place + ": the last unloading has " + std::to_string(force.size()) +
                    " points in the window of forces, wanted two or more; give a wider --window");
    const Line line = fit_line(deflection, force);
    if (!(line.slope > 0.0) || !std::isfinite(line.slope))
        throw Error(place + ": the force does not grow with the deflection in the last unloading");
    return {line, force.size()};
}

Json modulus_of(const io::Document& document, const Window& window) {
    expect_format(document, {"dem-bend"}, "modulus");
    const double span = positive_at(document, "span");
    const double width = positive_at(document, "width"), height = positive_at(document, "height");
    const double poisson_ratio = number_at(document, "poisson_ratio", -1.0);
    const double relative_density = positive_at(document, "relative_density");
    const auto [line, points] = unloading_line(curve_of(document), window, document.place);
    const double modulus = physics::bending_modulus(line.slope, span, width, height, poisson_ratio);
    const double error = modulus / line.slope * line.slope_error;
    Json result{{"format", "dem-modulus"},
                {"version", io::format_version},
                {"young_modulus", modulus},
                {"standard_error", std::isfinite(error) ? Json(error) : Json()},
                {"slope", line.slope},
                {"relative_density", relative_density},
                {"shear_correction", physics::shear_correction(height, span, poisson_ratio)},
                {"window", {window.upper, window.lower}},
                {"points", points}};
    for (const char* key : {"bond_law", "method", "history"})
        if (document.header.contains(key)) result[key] = document.header[key];
    return result;
}

}  // namespace

int modulus(int argc, char** argv) {
    Window window;
    CLI::App app{"Young's modulus from the force and deflection of three-point bending tests.", "analyze modulus"};
    app.footer(footer);
    app.add_option_function<std::string>(
           "--window", [&window](const std::string& text) { window = parse_window(text); },
           "force window of the unloading, UPPER:LOWER as shares of its peak; the paper's 50 N and 20 N of 60 N are 5/6:1/3")
        ->default_str("5/6:1/3");
    return report_each(app, argc, argv, columns, [&](const io::Document& document) {
        Json result = modulus_of(document, window);
        if (result.contains("history")) result["history"].push_back(cli::history_entry("analyze modulus", app, Json::object()));
        return result;
    });
}

}  // namespace kiln::analyze
