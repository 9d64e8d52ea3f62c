// fit.cpp: a law of Young's modulus against porosity through the results of several tests.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <limits>

#include "io/state_io.h"
#include "tools/analyze/analyze.h"
#include "tools/analyze/fit_points.h"
#include "analysis/law_fit.h"
#include "tools/analyze/report.h"
#include "analysis/student.h"
#include "tools/common/value_options.h"

namespace kiln::analyze {

namespace {

constexpr const char* fit_footer =
    "Reads dem-modulus documents (and dem-elastic ones) and tables (FILE.csv, .txt, .tsv, .dat, .asc), all of them for one fit; P "
    "= 1 - relative density is "
    "the porosity. A table has the columns relative_density (or porosity), young_modulus and, if there is one, standard_error, "
    "such as 'relative_density,young_modulus (GPa)' or 'porosity (%);E-modulus [GPa]', whatever else it has. Several laws give a "
    "document each, the best by AICc first.\n\n"
    "Keys of a result:\n"
    "  law, formula, source, weighting, degrees_of_freedom, r_squared, aic, aicc\n"
    "  E0 (Pa), b or Pc       the parameters; with standard_errors, covariance and confidence_intervals\n"
    "                         (95 %, Student's t)\n"
    "  dense_modulus          E0 by a name that jq can say, so ..._error and ..._interval\n"
    "  points, residuals      Pa, measured minus law\n"
    "  band                   {relative_density, young_modulus, and 95 % intervals (Pa) of the law,\n"
    "                         confidence, and of one more point, prediction}\n"
    "  references             curves of the literature, for alumina, at the same densities\n"
    "  data                   the measurements of --data, and how far they are from the law\n"
    "The scatter of the points about the law sets the scale of all errors; with as many points as parameters there is none, and "
    "the errors are null.\n\n";

constexpr const char* examples =
    "Examples:\n"
    "  bend bonded.kiln | analyze modulus | analyze fit --law knudsen --table\n"
    "  analyze fit --law all --table moduli.json\n"
    "  analyze fit --law power --data measured.csv moduli.json | jq .data.rms_deviation\n"
    "  analyze fit --law pabst measured.csv | jq .Pc";


/// Errors of moduli smaller than this share of them are those of a computed straight line and say nothing about the points.
constexpr double min_error = 1e-6;

enum class Weights { automatic, errors, equal };

/// Whether the points are weighted by their errors.
bool weighted(const Points& points, Weights weights) {
    if (weights == Weights::equal) return false;
    const double least = weights == Weights::errors ? 0.0 : min_error;
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

/// The law, its 95 % intervals and the curves of the literature at densities from the lowest of the points to 1.
void add_band(Json& result, const physics::PorosityLaw& law, const analysis::Fit& fit, const Points& points,
              const std::vector<double>& weight) {
    constexpr int steps = 40;
    const double t = fit.covariance ? analysis::student_factor(fit.degrees_of_freedom, confidence) : 0.0;
    double mean_weight = 0.0;
    for (const double each : weight) mean_weight += each / static_cast<double>(weight.size());
    const double lowest = 0.05 * std::floor(20.0 * (1.0 - std::ranges::max(points.porosity)));
    Json density = Json::array(), modulus = Json::array(), certain = Json::array(), predicted = Json::array(),
         curves = Json::array();
    for (const physics::ReferenceCurve& reference : physics::reference_curves())
        curves.push_back({{"name", reference.name},
                          {"formula", reference.formula},
                          {"source", reference.source},
                          {"young_modulus", Json::array()}});
    for (int step = 0; step <= steps; ++step) {
        const double porosity = (1.0 - lowest) * (1.0 - step / static_cast<double>(steps));
        const double value = law.modulus(porosity, fit.parameters);
        density.push_back(1.0 - porosity);
        modulus.push_back(value);
        for (std::size_t curve = 0; curve < physics::reference_curves().size(); ++curve) {
            const physics::ReferenceCurve& reference = physics::reference_curves()[curve];
            curves[curve]["young_modulus"].push_back(porosity <= reference.max_porosity ? Json(reference.modulus(porosity))
                                                                                            : Json());
        }
        if (!fit.covariance) continue;
        const double error = analysis::error_at(law, fit, porosity);
        const double wide = std::sqrt(error * error + fit.scatter / mean_weight);
        certain.push_back({value - t * error, value + t * error});
        predicted.push_back({value - t * wide, value + t * wide});
    }
    result["band"] = {{"relative_density", density}, {"young_modulus", modulus}};
    result["band"]["confidence"] = fit.covariance ? certain : Json();
    result["band"]["prediction"] = fit.covariance ? predicted : Json();
    result["references"] = curves;
}

/// Measurements beside the fit, and how far they lie from it: the root of the mean square of measured over law minus 1.
Json overlay_json(const physics::PorosityLaw& law, const analysis::Fit& fit, const Points& data) {
    double squares = 0.0;
    for (std::size_t point = 0; point < data.modulus.size(); ++point) {
        const double off = data.modulus[point] / law.modulus(data.porosity[point], fit.parameters) - 1.0;
        squares += off * off;
    }
    return {{"points", points_json(data)}, {"rms_deviation", std::sqrt(squares / static_cast<double>(data.modulus.size()))}};
}

Json fit_json(const physics::PorosityLaw& law, const analysis::Fit& fit, const Points& points, bool by_errors) {
    Json result{{"format", "dem-fit"},
                {"version", io::format_version},
                {"law", law.name},
                {"formula", law.formula},
                {"source", law.source}};
    Json errors, intervals;
    for (std::size_t k = 0; k < law.parameters.size(); ++k) {
        const auto row = static_cast<Eigen::Index>(k);
        const std::string& name = law.parameters[k].name;
        result[name] = fit.parameters[k];
        errors[name] = intervals[name] = Json();
        if (!fit.covariance) continue;
        const double error = std::sqrt((*fit.covariance)(row, row)),
                     reach = analysis::student_factor(fit.degrees_of_freedom, confidence) * error;
        errors[name] = error;
        intervals[name] = {fit.parameters[k] - reach, fit.parameters[k] + reach};
    }
    result["dense_modulus"] = result["E0"];
    result["dense_modulus_error"] = errors["E0"];
    result["dense_modulus_interval"] = intervals["E0"];
    result["standard_errors"] = errors;
    result["confidence_intervals"] = intervals;
    result["covariance"] = fit.covariance ? matrix_json(*fit.covariance) : Json();
    result["points"] = points_json(points);
    result["residuals"] = fit.residuals;
    result["r_squared"] = fit.r_squared;
    result["aic"] = fit.aic;
    result["aicc"] = fit.aicc ? Json(*fit.aicc) : Json();
    result["weighting"] = by_errors ? "standard errors" : "equal";
    result["degrees_of_freedom"] = fit.degrees_of_freedom;
    return result;
}

std::string error_key(const physics::Parameter& parameter) { return parameter.name + " error"; }

/// with_data: measurements lie beside the fit.
std::vector<Column> columns_of(const std::vector<const physics::PorosityLaw*>& wanted, bool with_data) {
    std::vector<Column> columns{{"law", "law", ""}, {"formula", "formula", ""}};
    for (const physics::PorosityLaw* law : wanted)
        for (const physics::Parameter& parameter : law->parameters) {
            if (std::ranges::find(columns, parameter.name, &Column::key) != columns.end()) continue;
            columns.push_back({parameter.name, parameter.name, parameter.unit});
            columns.push_back({error_key(parameter), "its error", parameter.unit});
        }
    columns.insert(columns.end(),
                   {{"count", "points", ""}, {"weighting", "weighting", ""}, {"r_squared", "R2", ""}, {"aicc", "AICc", ""}});
    if (with_data) columns.push_back({"rms_deviation", "rms deviation of data", ""});
    return columns;
}

/// The result with what columns_of() asks for at its top level.
Json table_row(const physics::PorosityLaw& law, Json result) {
    for (const physics::Parameter& parameter : law.parameters)
        result[error_key(parameter)] = result["standard_errors"][parameter.name];
    result["count"] = result["points"].size();
    if (result.contains("data")) result["rms_deviation"] = result["data"]["rms_deviation"];
    return result;
}

/// The laws of a list such as "knudsen,power", or of "all".
std::vector<const physics::PorosityLaw*> laws_of(const std::string& names) {
    std::vector<const physics::PorosityLaw*> wanted;
    if (names == "all")
        for (const physics::PorosityLaw& law : physics::porosity_laws())
            if (!law.same_as_another) wanted.push_back(&law);
    for (std::size_t start = 0; names != "all" && start <= names.size();) {
        const std::size_t end = std::min(names.find(',', start), names.size());
        wanted.push_back(&physics::porosity_law(names.substr(start, end - start)));
        start = end + 1;
    }
    return wanted;
}

struct FitOptions {
    std::vector<const physics::PorosityLaw*> wanted{&physics::porosity_laws().front()};
    Weights weights = Weights::automatic;
    std::string data;
    bool table = false;

    void add_to(CLI::App& app);
};

/// "Laws:" and a line for each.
std::string law_list() {
    std::string list = "Laws:\n";
    for (const physics::PorosityLaw& law : physics::porosity_laws())
        list += "  " + law.name + std::string(15 - law.name.size(), ' ') + law.formula + "\n";
    return list + "\n";
}

void FitOptions::add_to(CLI::App& app) {
    app.add_option_function<std::string>(
           "--law",
           [this](const std::string& names) {
               try {
                   wanted = laws_of(names);
               } catch (const Error& error) {
                   throw CLI::ValidationError("--law", error.what());
               }
           },
           "Laws to fit, or all; they are listed below")
        ->type_name("LAW,...")
        ->default_str("knudsen");
    cli::add_choice(app, "--weights", weights,
                    {{"auto", Weights::automatic}, {"errors", Weights::errors}, {"equal", Weights::equal}},
                    "errors: by the standard errors of the moduli; equal: all points alike; auto: by the errors if every modulus "
                    "has one above 1e-6 of it, else equal");
    app.add_option("--data", data, "Measurements that are not fitted, to lie beside the fit: a table as below")
        ->type_name("FILE.csv");
    add_table(app, table);
}

/// Results of all wanted laws, the best first where there are several.
std::vector<std::pair<const physics::PorosityLaw*, Json>> results_of(const FitOptions& options, const Points& points, bool quiet) {
    const bool by_errors = weighted(points, options.weights);
    std::vector<double> weight(points.error.size(), 1.0);
    if (by_errors) std::ranges::transform(points.error, weight.begin(), [](double error) { return 1.0 / (error * error); });
    Points data;
    if (!options.data.empty()) add_table_points(data, options.data);
    std::vector<std::pair<const physics::PorosityLaw*, Json>> results;
    std::string exact;  // names of the laws that go through all points
    for (const physics::PorosityLaw* law : options.wanted) {
        const analysis::Fit found = analysis::fit_law(*law, points.porosity, points.modulus, weight);
        if (found.degrees_of_freedom == 0) exact += (exact.empty() ? "" : ", ") + law->name;
        Json result = fit_json(*law, found, points, by_errors);
        add_band(result, *law, found, points, weight);
        if (!options.data.empty()) result["data"] = overlay_json(*law, found, data);
        results.emplace_back(law, std::move(result));
    }
    if (!exact.empty() && !quiet)
        cli::warn("analyze fit", exact + ": as many points as parameters, so the standard errors are unknown");
    const auto criterion = [](const auto& entry) {
        const Json& corrected = entry.second["aicc"];
        return corrected.is_null() ? std::numeric_limits<double>::infinity() : corrected.template get<double>();
    };
    std::ranges::stable_sort(results, {}, criterion);
    return results;
}

}  // namespace

int fit(int argc, char** argv) {
    cli::Common common;
    FitOptions options;
    CLI::App app{"Fits laws of Young's modulus against porosity by weighted least squares.", "analyze fit"};
    app.footer(fit_footer + law_list() + examples);
    options.add_to(app);
    common.add_to(app, true, false);
    cli::parse(app, argc, argv, common);

    const Points points = read_points(common.files);
    Report report(common, options.table, columns_of(options.wanted, !options.data.empty()));
    for (auto& [law, result] : results_of(options, points, common.quiet))
        report.add(options.table ? table_row(*law, std::move(result)) : std::move(result));
    report.finish();
    return cli::done;
}

}  // namespace kiln::analyze
