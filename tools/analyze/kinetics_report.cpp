// kinetics_report.cpp: fits bodies to measured curves, and puts constants, predictions, bands and warnings into JSON.
#include "tools/analyze/kinetics_report.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/activation_energy.h"
#include "core/types.h"
#include "io/material_io.h"
#include "physics/diffusion.h"
#include "physics/materials.h"

namespace kiln::analyze {

using analysis::DensityCurve, analysis::FiringPrediction, analysis::KineticConstants, analysis::KineticFit, analysis::SimulatedRun;

namespace {

constexpr double max_correction = 0.05;    // change of the density since a run, above which the run is not used to correct by
constexpr double tell_apart = 0.95;        // correlation above which two constants are not told apart
constexpr double wide_interval = 10.0;     // factor between the ends of an interval
constexpr double same_start = 0.01;        // of measured and simulated densities
constexpr std::size_t enough_grains = 5000;
constexpr std::size_t drawn_points = 60;   // of a curve in a figure

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(); }

/// Root of the mean square and largest size of differences.
Json deviations_json(const std::vector<double>& measured, const std::vector<double>& other) {
    double squares = 0.0, largest = 0.0;
    for (std::size_t row = 0; row < measured.size(); ++row) {
        const double off = measured[row] - other[row];
        squares += off * off;
        largest = std::max(largest, std::abs(off));
    }
    return {{"rms", std::sqrt(squares / static_cast<double>(measured.size()))}, {"max", largest}};
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
    double largest = 0.0;
    for (std::size_t row = 0; row < a.size(); ++row) largest = std::max(largest, std::abs(a[row] - b[row]));
    return largest;
}

/// All that is fitted: curves, then firings.
std::vector<DensityCurve> fitted_curves(const Measured& measured) {
    std::vector<DensityCurve> curves = measured.fitted;
    curves.insert(curves.end(), measured.firings.begin(), measured.firings.end());
    return curves;
}

/// All that is predicted, fitted or not.
std::vector<DensityCurve> all_curves(const Measured& measured) {
    std::vector<DensityCurve> curves = fitted_curves(measured);
    curves.insert(curves.end(), measured.held_out.begin(), measured.held_out.end());
    curves.insert(curves.end(), measured.predicted.begin(), measured.predicted.end());
    return curves;
}

bool single(const DensityCurve& curve) { return curve.size() == 1; }

/// Evenly spaced times from the first to the last of a curve; the last alone for one of a single density.
std::vector<double> drawn_times(const DensityCurve& curve) {
    if (single(curve)) return curve.time;
    std::vector<double> times;
    for (std::size_t point = 0; point < drawn_points; ++point)
        times.push_back(curve.time.front() +
                        (curve.time.back() - curve.time.front()) * static_cast<double>(point) / (drawn_points - 1.0));
    return times;
}

/// A body, its model and what was fitted to it.
struct FittedBody {
    const Body& body;
    analysis::DensificationModel model;
    Material material;  // surface energy, atomic volume
    KineticFit fit;

    FittedBody(const Body& body_, const Measured& measured)
        : body(body_), model(body_.runs), material(body_.runs.front().material) {
        analysis::KineticProblem problem;
        problem.curves = fitted_curves(measured);
        problem.runs.assign(problem.curves.size(), nullptr);
        problem.grains = measured.grains;
        problem.material = material;
        problem.surface = body.runs.front().surface;
        set_bounds(problem);
        fit = analysis::fit_kinetics(model, problem);
        for (std::size_t curve = 0; curve < problem.curves.size(); ++curve) problem.runs[curve] = usable_run(problem.curves[curve]);
        if (std::ranges::any_of(problem.runs, [](const SimulatedRun* run) { return run != nullptr; }))
            fit = analysis::fit_kinetics(model, problem);
    }

    /// The run with the firing of a curve whose constants are nearest in what they make of the density, and how near that is.
    std::pair<const SimulatedRun*, double> nearest_run(const DensityCurve& curve) const {
        const SimulatedRun* nearest = nullptr;
        double shift = std::numeric_limits<double>::infinity();
        for (const SimulatedRun& run : body.runs) {
            if (!analysis::follows(run, curve.schedule, curve.time)) continue;
            FiringPrediction firing(model, material, curve.schedule, curve.time);
            const std::vector<double> before = firing.densities(fit.constants);
            firing.correct_by(run);
            const analysis::MonotoneCurve simulated(run.time, run.density);
            std::vector<double> ran;
            for (const double time : curve.time) ran.push_back(simulated.at(time));
            const double distance = largest_difference(firing.densities(fit.constants), ran);
            if (distance < shift) {
                nearest = &run;
                shift = distance;
            }
        }
        return {nearest, shift};
    }

    const SimulatedRun* usable_run(const DensityCurve& curve) const {
        const auto [run, shift] = nearest_run(curve);
        return shift <= max_correction ? run : nullptr;
    }

    /// Predicted densities at times of a curve's firing.
    std::vector<double> densities(const DensityCurve& curve, const std::vector<double>& times) const {
        FiringPrediction firing(model, material, curve.schedule, times);
        if (const SimulatedRun* run = usable_run(curve)) firing.correct_by(*run);
        return firing.densities(fit.constants);
    }

    /// The bounds between which the ratio of D_s' to Delta is sought: those of the runs.
    void set_bounds(analysis::KineticProblem& problem) const {
        if (!problem.surface) return;
        const double temperature = analysis::reference_temperature(problem.curves);
        problem.min_ratio = std::numeric_limits<double>::infinity();
        for (const SimulatedRun& run : body.runs) {
            const double ratio = analysis::surface_rate(run.material, *run.surface, temperature) /
                                 analysis::boundary_rate(run.material, temperature);
            if (ratio > 0.0) problem.min_ratio = std::min(problem.min_ratio, ratio);
            problem.max_ratio = std::max(problem.max_ratio, ratio);
        }
        if (!(problem.max_ratio > problem.min_ratio))
            throw Error(body.name + ": runs with coarsening must differ in the ratio of surface diffusion to that along grain "
                        "boundaries, or nothing says what it does; make some with other surface_diffusion");
    }
};

Json constants_json(const KineticFit& fit) {
    Json constants{{"prefactor", fit.constants.boundary.prefactor},
                   {"activation_energy", fit.constants.boundary.activation_energy}};
    if (fit.constants.surface)
        constants["surface_diffusion"] = {{"prefactor", fit.constants.surface->prefactor},
                                          {"activation_energy", fit.constants.surface->activation_energy}};
    constants["reference_temperature"] = fit.reference_temperature;
    constants["diffusion_parameter"] = fit.diffusion;
    if (fit.constants.surface) constants["surface_diffusion_parameter"] = fit.surface_diffusion;
    return constants;
}

const std::vector<std::string> constant_names{"ln_diffusion_parameter", "activation_energy", "ln_surface_diffusion"};

/// Standard errors and correlations, null where they are not known.
void add_errors(Json& result, const KineticFit& fit) {
    result["degrees_of_freedom"] = fit.degrees_of_freedom;
    result["standard_errors"] = result["correlation"] = Json();
    if (!fit.covariance) return;
    const Eigen::MatrixXd& covariance = *fit.covariance;
    Json errors, names, rows = Json::array();
    for (Eigen::Index k = 0; k < covariance.rows(); ++k) {
        const std::string& name = constant_names[static_cast<std::size_t>(k)];
        errors[name] = std::sqrt(covariance(k, k));
        names.push_back(name);
        rows.push_back(Json::array());
        for (Eigen::Index j = 0; j < covariance.rows(); ++j)
            rows.back().push_back(covariance(k, j) / std::sqrt(covariance(k, k) * covariance(j, j)));
    }
    const double slope = 1.0 / (physics::gas_constant * fit.reference_temperature);  // of ln prefactor with the energy
    errors["ln_prefactor"] =
        std::sqrt(std::max(0.0, covariance(0, 0) + 2.0 * slope * covariance(0, 1) + slope * slope * covariance(1, 1)));
    result["standard_errors"] = errors;
    result["correlation"] = {{"of", names}, {"matrix", rows}};
    if (fit.surface_interval)
        result["surface_diffusion_interval"] = {fit.surface_interval->first, fit.surface_interval->second};
}

/// What a fit says of one curve.
Json curve_json(const FittedBody& fitted, const DensityCurve& curve, bool held_out) {
    const std::vector<double> densities = fitted.densities(curve, curve.time);
    Json result{{"name", curve.name}, {"held_out", held_out}, {"relative_density", densities}};
    const bool measured = !std::isnan(curve.density.front());
    if (measured) result.update(deviations_json(curve.density, densities));
    const auto [run, shift] = fitted.nearest_run(curve);
    if (run == nullptr) return result;
    const analysis::MonotoneCurve simulated(run->time, run->density);
    std::vector<double> ran;
    for (const double time : curve.time) ran.push_back(simulated.at(time));
    result["run"] = {{"name", run->name}, {"relative_density", ran}, {"shift", shift}};
    if (measured) result["run"].update(deviations_json(curve.density, ran));
    return result;
}

std::string percent(double value) { return Json(std::round(1000.0 * value) / 10.0).dump(); }

/// What a user should know of a fit, a sentence each.
Json warnings_of(const FittedBody& fitted, const Measured& measured) {
    Json warnings = Json::array();
    const KineticFit& fit = fitted.fit;
    if (fit.beyond) warnings.push_back("the runs do not become as dense as the measured curves; let them sinter further");
    if (fit.covariance)
        for (Eigen::Index k = 0; k < fit.covariance->rows(); ++k)
            for (Eigen::Index j = 0; j < k; ++j) {
                const double correlation =
                    (*fit.covariance)(k, j) / std::sqrt((*fit.covariance)(k, k) * (*fit.covariance)(j, j));
                if (std::abs(correlation) > tell_apart)
                    warnings.push_back("the curves hardly tell " + constant_names[static_cast<std::size_t>(j)] + " and " +
                                       constant_names[static_cast<std::size_t>(k)] + " apart: their correlation is " +
                                       Json(std::round(1e3 * correlation) / 1e3).dump());
            }
    if (fit.surface_at_bound)
        warnings.push_back("the surface diffusivity is at the end of the range that the runs cover: the curves do not tell it, "
                           "or runs with more or less of it are needed");
    if (fit.surface_interval && fit.surface_interval->second > wide_interval * fit.surface_interval->first)
        warnings.push_back("the surface diffusivity may be " +
                           Json(std::round(fit.surface_interval->second / fit.surface_interval->first)).dump() +
                           " times larger at one end of its interval than at the other");
    for (const DensityCurve& curve : measured.fitted)
        if (std::abs(curve.density.front() - fitted.model.start_density()) > same_start)
            warnings.push_back(curve.name + " begins at a relative density of " + percent(curve.density.front()) +
                               " %, the simulated body at " + percent(fitted.model.start_density()) + " %");
    if (fitted.body.particles > 0 && fitted.body.particles < enough_grains)
        warnings.push_back(std::to_string(fitted.body.particles) +
                           " grains are few: constants fitted to them miss for others by up "
                           "to 0.04 in density; 10,000 and three seeds are enough");
    return warnings;
}

Json grains_json(const FittedBody& fitted, const Measured& measured) {
    Json list = Json::array();
    for (const analysis::GrainSize& grain : measured.grains) {
        double log_size = 0.0;
        const std::vector<DensityCurve> curves = fitted_curves(measured);
        for (const DensityCurve& curve : curves)
            log_size += std::log(FiringPrediction(fitted.model, fitted.material, curve.schedule, curve.time)
                                     .diameter(fitted.fit.constants, grain.density)) /
                        static_cast<double>(curves.size());
        list.push_back({{"relative_density", grain.density}, {"measured", grain.diameter}, {"fitted", number(std::exp(log_size))}});
    }
    return list;
}

Material fitted_material(const FittedBody& fitted) {
    const KineticFit& fit = fitted.fit;
    Material material = fitted.material;
    if (!material.name.ends_with("-fitted")) material.name += "-fitted";
    material.diffusion_parameter.reset();
    material.diffusion_prefactor = fit.constants.boundary.prefactor;
    material.activation_energy = fit.constants.boundary.activation_energy;
    return material;
}

Json material_json_of(const FittedBody& fitted) {
    Json json = io::material_json(fitted_material(fitted));
    if (const auto& surface = fitted.fit.constants.surface)
        json["surface_diffusion"] = {{"prefactor", surface->prefactor}, {"activation_energy", surface->activation_energy}};
    return json;
}

Json body_json(const FittedBody& fitted, const Measured& measured) {
    Json result{{"name", fitted.body.name},
                {"runs", fitted.body.runs.size()},
                {"particles", fitted.body.particles > 0 ? Json(fitted.body.particles) : Json()},
                {"coarsening", fitted.model.coarsens()},
                {"constants", constants_json(fitted.fit)}};
    add_errors(result, fitted.fit);
    result["curves"] = Json::array();
    for (const DensityCurve& curve : fitted_curves(measured)) result["curves"].push_back(curve_json(fitted, curve, false));
    for (const auto* list : {&measured.held_out, &measured.predicted})
        for (const DensityCurve& curve : *list) result["curves"].push_back(curve_json(fitted, curve, true));
    if (!measured.grains.empty()) result["grain_sizes"] = grains_json(fitted, measured);
    result["warnings"] = warnings_of(fitted, measured);
    result["material"] = material_json_of(fitted);
    return result;
}

/// Lowest and highest of what the bodies predict along each curve.
Json band_json(const std::vector<FittedBody>& fitted, const Measured& measured) {
    Json band = Json::array();
    for (const DensityCurve& curve : all_curves(measured)) {
        const std::vector<double> times = drawn_times(curve);
        std::vector<double> first = fitted.front().densities(curve, times), low = first, high = first, temperature;
        for (const FittedBody& each : fitted) {
            const std::vector<double> densities = each.densities(curve, times);
            for (std::size_t row = 0; row < times.size(); ++row) {
                low[row] = std::min(low[row], densities[row]);
                high[row] = std::max(high[row], densities[row]);
            }
        }
        for (const double time : times) temperature.push_back(curve.schedule.temperature(time));
        band.push_back({{"name", curve.name},
                        {"time", times},
                        {"temperature", temperature},
                        {"relative_density", first},
                        {"minimum", low},
                        {"maximum", high}});
    }
    return band;
}

}  // namespace

Json model_free_json(const std::vector<DensityCurve>& curves, const std::vector<double>& densities) {
    Json list = Json::array();
    double sum = 0.0, squares = 0.0;
    const std::vector<analysis::IsoDensity> energies = analysis::iso_density_energies(curves, densities);
    if (energies.empty()) return nullptr;
    for (const analysis::IsoDensity& each : energies) {
        list.push_back({{"relative_density", each.density},
                        {"activation_energy", each.energy.value},
                        {"standard_error", number(each.energy.error)},
                        {"master_curve", analysis::narrowest_master_curve(curves, {each.density}).energy.value},
                        {"curves", each.curves}});
        sum += each.energy.value;
    }
    const auto count = static_cast<double>(energies.size());
    for (const analysis::IsoDensity& each : energies) squares += std::pow(each.energy.value - sum / count, 2);
    const analysis::MasterCurve master = analysis::narrowest_master_curve(curves, densities);
    return {{"iso_density",
             {{"activation_energy", sum / count},
              {"standard_deviation", energies.size() > 1 ? Json(std::sqrt(squares / (count - 1.0))) : Json()},
              {"densities", list}}},
            {"master_curve",
             {{"activation_energy", master.energy.value},
              {"standard_error", number(master.energy.error)},
              {"jackknife_over", master.error_from},
              {"width", master.width}}}};
}

Json bodies_json(const Measured& measured, const std::vector<Body>& bodies) {
    std::vector<FittedBody> fitted;
    fitted.reserve(bodies.size());
    for (const Body& body : bodies) fitted.emplace_back(body, measured);
    Json list = Json::array();
    for (const FittedBody& each : fitted) list.push_back(body_json(each, measured));
    return {{"bodies", list}, {"band", band_json(fitted, measured)}};
}

Json curves_json(const Measured& measured) {
    Json list = Json::array();
    const auto add = [&](const std::vector<DensityCurve>& curves, bool held_out) {
        for (const DensityCurve& curve : curves) {
            std::vector<double> temperature;
            for (const double time : curve.time) temperature.push_back(curve.schedule.temperature(time));
            const bool known = !std::isnan(curve.density.front());
            list.push_back({{"name", curve.name},
                            {"held_out", held_out},
                            {"time", curve.time},
                            {"temperature", temperature},
                            {"relative_density", known ? Json(curve.density) : Json()}});
        }
    };
    add(fitted_curves(measured), false);
    add(measured.held_out, true);
    add(measured.predicted, true);
    return list;
}

}  // namespace kiln::analyze
