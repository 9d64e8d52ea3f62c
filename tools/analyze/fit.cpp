// fit.cpp: a law of Young's modulus against porosity through the results of several tests.
#include <algorithm>
#include <cmath>
#include <map>

#include "io/state_io.h"
#include "tools/analyze/analyze.h"
#include "tools/analyze/laws.h"
#include "tools/analyze/report.h"
#include "tools/analyze/results.h"

namespace kiln::analyze {

namespace {

constexpr const char* footer =
    "Reads dem-modulus documents (and dem-elastic ones), all of them for one fit; P = 1 - relative density is the porosity.\n"
    "Keys: law, formula, E0 (Pa), b, standard_errors, covariance, points, residuals (Pa, measured minus law), r_squared, "
    "weighting, degrees_of_freedom. The scatter of the points about the law sets the scale of all errors; with as many points as "
    "parameters there is none, and the errors are null.\n"
    "Examples:\n"
    "  bend bonded.kiln | analyze modulus | analyze fit --law knudsen --table\n"
    "  analyze fit --law power tests.json | jq '.[\"E0\"]'";

/// Errors of moduli smaller than this share of them are those of a computed straight line and say nothing about the points.
constexpr double least_error = 1e-6;

enum class Weights { automatic, errors, equal };

struct Points {
    std::vector<double> porosity, modulus, error;  // -, Pa, Pa (NaN where there is none)
};

void add_point(Points& points, const io::Document& document) {
    expect_format(document, {"dem-modulus", "dem-elastic"}, "fit");
    const double density = positive_at(document, "relative_density");
    if (density > 1.0) throw Error(document.place + ": relative_density is " + Json(density).dump() + ", more than 1");
    points.porosity.push_back(1.0 - density);
    points.modulus.push_back(positive_at(document, "young_modulus"));
    const bool has_error = document.header.contains("standard_error") && !document.header["standard_error"].is_null();
    points.error.push_back(has_error ? number_at(document, "standard_error", 0.0) : std::nan(""));
}

/// Whether the points are weighted by their errors.
bool weighted(const Points& points, Weights weights) {
    if (weights == Weights::equal) return false;
    const double least = weights == Weights::errors ? 0.0 : least_error;
    for (std::size_t point = 0; point < points.error.size(); ++point) {
        if (points.error[point] > least * points.modulus[point]) continue;
        if (weights == Weights::errors)
            throw Error("point " + std::to_string(point + 1) + " has no standard error to weight it by");
        return false;
    }
    return true;
}

Json matrix_json(const Eigen::MatrixXd& matrix) {
    Json rows = Json::array();
    for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
        rows.push_back(Json::array());
        for (Eigen::Index column = 0; column < matrix.cols(); ++column) rows.back().push_back(matrix(row, column));
    }
    return rows;
}

Json fit_json(const Law& law, const Fit& fit, const Points& points, bool by_errors) {
    Json result{{"format", "dem-fit"}, {"version", io::format_version}, {"law", law.name}, {"formula", law.formula}};
    Json errors;
    for (std::size_t k = 0; k < law.parameters.size(); ++k) {
        const auto row = static_cast<Eigen::Index>(k);
        result[law.parameters[k].name] = fit.parameters[k];
        errors[law.parameters[k].name] = fit.covariance ? Json(std::sqrt((*fit.covariance)(row, row))) : Json();
    }
    result["standard_errors"] = errors;
    result["covariance"] = fit.covariance ? matrix_json(*fit.covariance) : Json();
    result["points"] = Json::array();
    for (std::size_t point = 0; point < points.modulus.size(); ++point)
        result["points"].push_back({{"porosity", points.porosity[point]},
                                    {"young_modulus", points.modulus[point]},
                                    {"standard_error", std::isnan(points.error[point]) ? Json() : Json(points.error[point])}});
    result["residuals"] = fit.residuals;
    result["r_squared"] = fit.r_squared;
    result["weighting"] = by_errors ? "standard errors" : "equal";
    result["degrees_of_freedom"] = fit.degrees_of_freedom;
    return result;
}

std::string error_key(const Parameter& parameter) { return parameter.name + " error"; }

std::vector<Column> columns_of(const Law& law) {
    std::vector<Column> columns{{"formula", "law", ""}};
    for (const Parameter& parameter : law.parameters) {
        columns.push_back({parameter.name, parameter.name, parameter.unit});
        columns.push_back({error_key(parameter), "its error", parameter.unit});
    }
    columns.insert(columns.end(), {{"count", "points", ""}, {"weighting", "weighting", ""}, {"r_squared", "R2", ""}});
    return columns;
}

/// The result with what columns_of() asks for at its top level.
Json table_row(const Law& law, Json result) {
    for (const Parameter& parameter : law.parameters) result[error_key(parameter)] = result["standard_errors"][parameter.name];
    result["count"] = result["points"].size();
    return result;
}

}  // namespace

int fit(int argc, char** argv) {
    cli::Common common;
    bool table = false;
    std::string name = "knudsen";
    Weights weights = Weights::automatic;
    const std::map<std::string, Weights> weightings{
        {"auto", Weights::automatic}, {"errors", Weights::errors}, {"equal", Weights::equal}};
    std::vector<std::string> names;
    for (const Law& law : laws()) names.push_back(law.name);
    CLI::App app{"Fits a law of Young's modulus against porosity by weighted least squares.", "analyze fit"};
    app.footer(footer);
    app.add_option("--law", name, "knudsen: E0 exp(-b P); linear: E0 (1 - b P); power: E0 (1 - P)^b")
        ->check(CLI::IsMember(names))
        ->capture_default_str();
    app.add_option_function<std::string>(
           "--weights", [&](const std::string& text) { weights = weightings.at(text); },
           "errors: by the standard errors of the moduli; equal: all points alike; auto: by the errors if every modulus "
           "has one above 1e-6 of it, else equal")
        ->check(CLI::IsMember(weightings))
        ->default_str("auto");
    add_table(app, table);
    common.add_to(app);
    cli::parse(app, argc, argv, common);

    io::Input input(common.files);
    Points points;
    while (const auto document = input.next()) add_point(points, *document);
    const bool by_errors = weighted(points, weights);
    std::vector<double> weight(points.error.size(), 1.0);
    if (by_errors) std::ranges::transform(points.error, weight.begin(), [](double error) { return 1.0 / (error * error); });

    const Law& law = law_named(name);
    const Fit found = fit_law(law, points.porosity, points.modulus, weight);
    if (found.degrees_of_freedom == 0 && !common.quiet)
        cli::warn("analyze fit", "as many points as parameters: the standard errors are unknown");
    const Json result = fit_json(law, found, points, by_errors);
    Report report(common, table, columns_of(law));
    report.add(table ? table_row(law, result) : result);
    report.finish();
    return cli::done;
}

}  // namespace kiln::analyze
