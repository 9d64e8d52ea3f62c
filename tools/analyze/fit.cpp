// fit.cpp: a law of Young's modulus against porosity through the results of several tests.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>

#include "io/state_io.h"
#include "tools/analyze/analyze.h"
#include "tools/analyze/fit_points.h"
#include "analysis/law_fit.h"
#include "tools/analyze/report.h"
#include "tools/analyze/results.h"
#include "tools/analyze/table_material.h"
#include "analysis/student.h"
#include "tools/common/value_options.h"

namespace kiln::analyze {

namespace {

constexpr const char* fit_footer =
    "Reads dem-modulus documents (and dem-elastic ones) and tables (FILE.csv, .txt, .tsv, .dat, .asc), all of them for one fit; P "
    "= 1 - relative density is "
    "the porosity. A table has the columns relative_density (or porosity), young_modulus and, if there is one, standard_error, "
    "such as 'relative_density,young_modulus (GPa)' or 'porosity (%);E-modulus [GPa]', whatever else it has. Several laws give a "
    "document each, the best by AICc first; without a rank and in their own order where the points are too few for that.\n\n"
    "Keys of a result:\n"
    "  material             names in one text; null where nothing says it\n"
    "  law, formula, source, weighting, degrees_of_freedom, r_squared, aic, aicc\n"
    "  rank, aicc_difference  of several laws, from the best; null where one has no aicc\n"
    "  E0, b, Pc            the law's parameters; E0 in Pa\n"
    "  standard_errors, confidence_intervals, covariance\n"
    "                       of the parameters; intervals of 95 %, Student's t\n"
    "  not_determined       parameters whose interval reaches farther than they are large: the points\n"
    "                       say nothing of them\n"
    "  dense_modulus, dense_modulus_error, dense_modulus_interval\n"
    "                       E0 by names that jq can say\n"
    "  points               {porosity, young_modulus, standard_error, bond_law, material, test}; test:\n"
    "                       bending, cell, voxels or measured\n"
    "  residuals            Pa, measured minus law\n"
    "  warnings             sentences that the tests of the points have, such as of short bars\n"
    "  band                 {relative_density, young_modulus, confidence, prediction}: the law, and its\n"
    "                       95 % intervals (Pa), of itself and of one more point\n"
    "  references           {name, formula, source, young_modulus}: curves of the literature at the same\n"
    "                       densities, of alumina where all points are\n"
    "  data                 {points, relative_rms_deviation, rms_deviation}: of --data; the root of the\n"
    "                       mean square of measured over law minus 1, and of measured minus law, Pa\n"
    "The scatter of the points about the law sets the scale of all errors; with as many points as parameters there is none, and "
    "the errors are null.\n\n";

constexpr const char* examples =
    "Examples:\n"
    "  bend bonded.kiln | analyze modulus | analyze fit --law knudsen --table\n"
    "  analyze fit --law all --table moduli.json\n"
    "  analyze fit --law power --data measured.csv moduli.json | jq .data.relative_rms_deviation\n"
    "  analyze fit --law pabst measured.csv | jq .Pc";


/// Errors of moduli smaller than this share of them are those of a computed straight line and say nothing about the points.
constexpr double min_error = 1e-6;

/// Difference of AICc below which neither of two laws is the better one (Burnham & Anderson, Model Selection, 2002).
constexpr double clear_difference = 2.0;

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

/// The curves of the literature for what the points consist of: all are alumina's, so none where a point is, or may be, of another.
std::vector<physics::ReferenceCurve> references_of(const Points& points) {
    const auto is_alumina = [](const Json& name) { return name.is_string() && name.get<std::string>().starts_with("alumina"); };
    return std::ranges::all_of(points.material, is_alumina) ? physics::reference_curves() : std::vector<physics::ReferenceCurve>{};
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
    const std::vector<physics::ReferenceCurve> references = references_of(points);
    for (const physics::ReferenceCurve& reference : references)
        curves.push_back({{"name", reference.name},
                          {"formula", reference.formula},
                          {"source", reference.source},
                          {"young_modulus", Json::array()}});
    for (int step = 0; step <= steps; ++step) {
        const double porosity = (1.0 - lowest) * (1.0 - step / static_cast<double>(steps));
        const double value = law.modulus(porosity, fit.parameters);
        density.push_back(1.0 - porosity);
        modulus.push_back(value);
        for (std::size_t curve = 0; curve < references.size(); ++curve) {
            const physics::ReferenceCurve& reference = references[curve];
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

/// Measurements beside the fit, and how far they lie from it: the root of the mean square of measured over law minus 1, a fraction,
/// and that of measured minus law, Pa.
Json overlay_json(const physics::PorosityLaw& law, const analysis::Fit& fit, const Points& data) {
    double squares = 0.0, relative_squares = 0.0;
    const auto count = static_cast<double>(data.modulus.size());
    for (std::size_t point = 0; point < data.modulus.size(); ++point) {
        const double value = law.modulus(data.porosity[point], fit.parameters), off = data.modulus[point] - value;
        squares += off * off;
        relative_squares += off * off / (value * value);
    }
    return {{"points", points_json(data)},
            {"relative_rms_deviation", std::sqrt(relative_squares / count)},
            {"rms_deviation", std::sqrt(squares / count)}};
}

Json fit_json(const physics::PorosityLaw& law, const analysis::Fit& fit, const Points& points, bool by_errors) {
    Json result{{"format", "dem-fit"},
                {"version", io::format_version},
                {"material", joined_materials(points_json(points).get<std::vector<Json>>())},
                {"law", law.name},
                {"formula", law.formula},
                {"source", law.source}};
    Json errors, intervals, undetermined = Json::array();
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
        if (says_nothing(fit.parameters[k], reach)) undetermined.push_back(name);
    }
    result["dense_modulus"] = result["E0"];
    result["dense_modulus_error"] = errors["E0"];
    result["dense_modulus_interval"] = intervals["E0"];
    result["not_determined"] = undetermined;
    result["standard_errors"] = errors;
    result["confidence_intervals"] = intervals;
    result["covariance"] = fit.covariance ? matrix_json(*fit.covariance) : Json();
    result["points"] = points_json(points);
    result["warnings"] = points.warnings;
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
    std::vector<Column> columns{{"material", "material", ""}, {"law", "law", ""}, {"formula", "formula", ""}};
    for (const physics::PorosityLaw* law : wanted)
        for (const physics::Parameter& parameter : law->parameters) {
            if (std::ranges::find(columns, parameter.name, &Column::key) != columns.end()) continue;
            columns.push_back({parameter.name, parameter.name, parameter.unit});
            columns.push_back({error_key(parameter), "its error", parameter.unit});
        }
    columns.insert(columns.end(),
                   {{"count", "points", ""}, {"weighting", "weighting", ""}, {"r_squared", "R2", ""}, {"rank", "rank", ""},
                    {"aicc", "AICc", ""}});
    if (with_data) {
        columns.push_back({"rms_deviation", "rms deviation of data", "Pa"});
        columns.push_back({"percent_deviation", "the same, %", ""});
    }
    return columns;
}

/// The result with what columns_of() asks for at its top level.
Json table_row(const physics::PorosityLaw& law, Json result) {
    for (const physics::Parameter& parameter : law.parameters)
        result[error_key(parameter)] = result["standard_errors"][parameter.name];
    result["count"] = result["points"].size();
    for (const Json& name : result["not_determined"]) result[name.get<std::string>() + " error"] = not_determined;
    if (result.contains("data")) {
        result["rms_deviation"] = result["data"]["rms_deviation"];
        result["percent_deviation"] = 100.0 * result["data"]["relative_rms_deviation"].get<double>();
    }
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
    TableMaterial material;
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
    material.add_to(app, "its name stands in the result, and curves of the literature are drawn for alumina only");
    add_table(app, table);
}

using Results = std::vector<std::pair<const physics::PorosityLaw*, Json>>;

/// Puts the best law first and gives each its rank by AICc; where a law has none, all keep their order and their rank is null.
void rank(Results& results, std::size_t points, bool quiet) {
    std::string without;  // names of the laws that have no AICc
    std::size_t needed = 0;
    for (auto& [law, result] : results) {
        result["rank"] = nullptr;
        result["aicc_difference"] = nullptr;
        if (!result["aicc"].is_null()) continue;
        without += (without.empty() ? "" : ", ") + law->name;
        needed = std::max(needed, law->parameters.size() + 3);
    }
    if (results.size() < 2) return;
    if (!without.empty()) {
        if (!quiet)
            cli::warn("analyze fit", "the laws are not ranked: by AICc a law of " + std::to_string(needed - 3) +
                                         " parameters takes " + std::to_string(needed) +
                                         " points or more to be compared, and there are " + std::to_string(points) + " (" +
                                         without + ")");
        return;
    }
    const auto criterion = [](const auto& entry) { return entry.second["aicc"].template get<double>(); };
    std::ranges::stable_sort(results, {}, criterion);
    std::string alike;
    for (std::size_t place = 0; place < results.size(); ++place) {
        Json& result = results[place].second;
        const double difference = criterion(results[place]) - criterion(results.front());
        result["rank"] = place + 1;
        result["aicc_difference"] = difference;
        if (place > 0 && difference < clear_difference) alike += ", " + results[place].first->name;
    }
    if (!alike.empty() && !quiet)
        cli::warn("analyze fit", "the points do not tell apart " + results.front().first->name + alike +
                                     ": their AICc differ by less than 2");
}

/// Results of all wanted laws, the best first where there are several.
Results results_of(const FitOptions& options, const Points& points, bool quiet) {
    const bool by_errors = weighted(points, options.weights);
    std::vector<double> weight(points.error.size(), 1.0);
    if (by_errors) std::ranges::transform(points.error, weight.begin(), [](double error) { return 1.0 / (error * error); });
    Points data;
    if (!options.data.empty()) add_table_points(data, options.data, options.material);
    Results results;
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
    rank(results, points.modulus.size(), quiet);
    return results;
}

/// Warns of points of several solids: one law goes through one.
void check_materials(const Points& points, bool quiet) {
    const Json names = joined_materials(points_json(points).get<std::vector<Json>>());
    const bool several = std::ranges::any_of(points.material, [&](const Json& name) { return name != names; });
    if (several && names.is_string() && !quiet)
        cli::warn("analyze fit", "the points are not all of one material (" + names.get<std::string>() +
                                     (std::ranges::count(points.material, Json()) > 0 ? ", and some do not say of which" : "") +
                                     ")");
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

    const Points points = read_points(common.files, options.material);
    check_materials(points, common.quiet);
    Report report(common, options.table, columns_of(options.wanted, !options.data.empty()));
    for (auto& [law, result] : results_of(options, points, common.quiet))
        report.add(options.table ? table_row(*law, std::move(result)) : std::move(result));
    report.finish();
    return cli::done;
}

}  // namespace kiln::analyze
