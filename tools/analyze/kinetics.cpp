// kinetics.cpp: activation energies of measured curves, and the constants with which simulated bodies follow them.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>

#include "io/files.h"
#include "io/material_io.h"
#include "io/state_io.h"
#include "tools/analyze/analyze.h"
#include "tools/analyze/kinetics_report.h"
#include "tools/analyze/report.h"
#include "tools/common/quantity_options.h"
#include "tools/common/value_options.h"

namespace kiln::analyze {

namespace {

constexpr const char* kinetics_footer =
    "A curve is a table FILE.csv with a column 'temperature (C)' and\n"
    "  - columns of relative density headed by heating rates, '5 K/min'; FILE.csv:5K/min is one;\n"
    "  - or 'time (min)', and 'relative_density', 'dL/L0' (negative where it shrinks) or 'shrinkage';\n"
    "  - or one of these without times, under the heating rate of FILE.csv:5K/min, from 25 C on.\n"
    "Shrinkage requires --green-density; it counts as the same along all axes.\n\n"
    "FILE is a history of `sinter --history`, behind the state that its run wrote: `sintered.kiln history.jsonl`. The state says "
    "the material, the schedule, and which runs are of one body under the same options; without it the material is that of "
    "--material. Without any FILE the activation energies are all there is. Without coarsening one run fits all curves. With "
    "coarsening runs of one body with other surface_diffusion are required; runs that have the firing and nearly the constants of "
    "a "
    "curve correct what was interpolated, and are themselves compared.\n\n"
    "Keys of the result:\n"
    "  curves         as read {name, held_out, time, temperature, relative_density}\n"
    "  model_free     {iso_density, master_curve}, null for one curve\n"
    "  iso_density    Wang & Raj, a line at each density\n"
    "                 {activation_energy, standard_deviation, densities}\n"
    "  densities      of each {relative_density, activation_energy, standard_error, master_curve, curves}\n"
    "  master_curve   Su & Johnson, the narrowest {activation_energy, standard_error, jackknife_over,\n"
    "                 width}; jackknife_over: what was left out for its error\n"
    "  bodies         of each {name, runs, particles, coarsening, constants, standard_errors,\n"
    "                 correlation, degrees_of_freedom, curves, grain_sizes, warnings, material}\n"
    "  constants      {prefactor, activation_energy, reference_temperature, diffusion_parameter (at that\n"
    "                 temperature), surface_diffusion}\n"
    "  standard_errors  {ln_diffusion_parameter, ln_prefactor, activation_energy}\n"
    "  curves         of a body {name, held_out, relative_density, rms, max, run}; rms and max of\n"
    "                 measured less simulated density; run: the nearest run's own\n"
    "  band           along each curve {name, time, temperature, relative_density, minimum, maximum}: of\n"
    "                 the first body, the lowest and highest of all\n"
    "  material       of the first body, with the fitted constants\n"
    "J/mol, m3/s, K, s, m. Errors take the points for independent, which those of a smooth curve are not.\n"
    "A good fit of densities alone is no evidence for coarsening; --grain-size narrows it (docs/kinetics.md).\n\n"
    "Examples:\n"
    "  analyze kinetics --curve dilatometer.csv --table\n"
    "  sinter --temperature 1300C --to-density 0.9 --history history.jsonl -o dense.kiln green.kiln\n"
    "  analyze kinetics --curve dilatometer.csv --hold-out dilatometer.csv:10K/min \\\n"
    "      --save-material fitted.json dense.kiln history.jsonl | jq .bodies[0].constants\n"
    "  analyze kinetics --firing \"25C 10K/min 1100C 1h = 0.67\" --firing \"25C 10K/min 1250C 1h = 0.88\" \\\n"
    "      --predict \"25C 10K/min 1200C 1h\" --table dense.kiln history.jsonl";

const std::vector<Column> kinetics_columns{{"from", "from", ""},
                                           {"curves", "curves", ""},
                                           {"activation_energy", "activation energy, kJ/mol", ""},
                                           {"error", "its error", ""},
                                           {"prefactor", "prefactor, m3/s", ""},
                                           {"surface", "surface, m3/s", ""},
                                           {"rms", "rms deviation of density", ""},
                                           {"max", "largest", ""},
                                           {"held_out", "largest, held out", ""},
                                           {"material", "material", ""}};

constexpr std::size_t densities_by_default = 11;

struct KineticsOptions {
    std::vector<std::string> curves, held_out, firings, predicted;
    std::vector<double> densities;
    Dilatometer dilatometer;
    std::string grain_sizes, material, save_material;
    bool table = false;

    void add_to(CLI::App& app);
    void check(const CLI::App& app, const cli::Common& common) const;
    Measured read() const;
};

/// Refuses what is no schedule, or has no density where one is required.
CLI::Validator is_firing(bool density) {
    return {[density](const std::string& text) {
                try {
                    read_firing(text, density);
                } catch (const TextError& error) {
                    return std::string(error.what());
                }
                return std::string();
            },
            ""};
}

void KineticsOptions::add_to(CLI::App& app) {
    const auto add_list = [&app](const std::string& name, std::vector<std::string>& target, const std::string& type,
                                 const std::string& help) {
        return app.add_option(name, target, help + "; may be given several times")->type_name(type)->allow_extra_args(false);
    };
    add_list("--curve", curves, "FILE.csv[:RATE]", "Measured curve or curves, see below");
    add_list("--hold-out", held_out, "FILE.csv[:RATE]",
             "Curve that is not fitted but compared; taken out of the curves of --curve");
    add_list("--firing", firings, "WORDS", "Schedule and the density measured after it, \"25C 10K/min 1200C 1h = 0.79\"")
        ->check(is_firing(true));
    add_list("--predict", predicted, "WORDS", "Schedule whose density is not fitted; with one after = it is compared")
        ->check(is_firing(false));
    app.add_option_function<std::string>(
           "--green-density",
           [this](const std::string& text) {
               dilatometer.green_density = cli::number_from<double>("--green-density", text, {cli::above_zero, 1.0});
           },
           "Relative density of the body before its shrinkage" + cli::known_bounds(cli::Bounds<double>{0.0, 1.0}))
        ->type_name("NUMBER");
    cli::add_number(app, "--expansion", dilatometer.expansion, {0.0, 1e-3},
                    "Thermal expansion of the length per K from 25 C on, which is in a dilatometer's dL/L0; alumina 8e-6");
    cli::add_quantities(app, "--densities", densities, io::Dimension::none,
                        "Relative densities at which activation energies are found (default: 11 that all curves pass)");
    app.add_option("--grain-size", grain_sizes,
                   "Measured grain sizes, fitted with the densities: relative_density, and 'grain size (um)' as mean diameter or "
                   "'mean intercept (um)', and standard_error")
        ->type_name("FILE.csv");
    app.add_option("--material", material, "Material of histories without a state that names one: built-in, or a file NAME.json")
        ->type_name("NAME");
    app.add_option("--save-material", save_material, "File for the first body's material, for sinter green --material")
        ->type_name("FILE.json");
    add_table(app, table);
}

void KineticsOptions::check(const CLI::App& app, const cli::Common& common) const {
    if (curves.empty() && firings.empty()) throw CLI::ValidationError("one of --curve and --firing is required");
    for (const double density : densities)
        if (!(density > 0.0 && density < 1.0)) throw CLI::ValidationError("--densities: a relative density lies between 0 and 1");
    const bool simulated = !common.files.empty();
    for (const char* name : {"--hold-out", "--firing", "--predict", "--grain-size", "--material", "--save-material"})
        if (!simulated && app.count(name) > 0 && !(std::string(name) == "--hold-out" && !curves.empty()))
            throw CLI::ValidationError(name, "has no meaning without a simulated history");
    if (app.count("--expansion") > 0 && dilatometer.green_density == 0.0)
        throw CLI::ValidationError("--expansion", "has no meaning without --green-density");
    if (curves.empty() && app.count("--densities") > 0)
        throw CLI::ValidationError("--densities", "has no meaning without --curve");
}

Measured KineticsOptions::read() const {
    Measured measured;
    std::vector<std::string> held;
    for (const std::string& text : held_out)
        for (MeasuredCurve& each : read_curves(text, dilatometer)) {
            held.push_back(each.source);
            measured.held_out.push_back(std::move(each.curve));
        }
    for (const std::string& text : curves)
        for (MeasuredCurve& each : read_curves(text, dilatometer))
            if (std::ranges::find(held, each.source) == held.end()) measured.fitted.push_back(std::move(each.curve));
    if (!curves.empty() && measured.fitted.empty()) throw Error("all curves are held out, and none is left to fit");
    for (const std::string& text : firings) measured.firings.push_back(read_firing(text, true));
    for (const std::string& text : predicted) measured.predicted.push_back(read_firing(text, false));
    if (!grain_sizes.empty()) measured.grains = read_grain_sizes(grain_sizes);
    return measured;
}

/// Standard error of the activation energy, kJ/mol, where it is below the energy.
Json error_cell(const Json& body) {
    if (body["standard_errors"].is_null()) return nullptr;
    const double error = body["standard_errors"]["activation_energy"].get<double>();
    return says_nothing(body["constants"]["activation_energy"].get<double>(), error) ? Json(not_determined) : Json(error / 1e3);
}

/// Rows of the table: what was found without a model, then each body.
std::vector<Json> table_rows(const Json& result, std::size_t curves) {
    constexpr double kilo = 1e3;
    std::vector<Json> rows;
    const auto in_kilo = [](const Json& value) { return value.is_null() ? Json() : Json(value.get<double>() / kilo); };
    if (const Json& free = result["model_free"]; !free.is_null()) {
        rows.push_back({{"from", "iso-density lines"},
                        {"curves", curves},
                        {"activation_energy", in_kilo(free["iso_density"]["activation_energy"])},
                        {"error", in_kilo(free["iso_density"]["standard_deviation"])}});
        rows.push_back({{"from", "narrowest master curve"},
                        {"curves", curves},
                        {"activation_energy", in_kilo(free["master_curve"]["activation_energy"])},
                        {"error", in_kilo(free["master_curve"]["standard_error"])}});
    }
    if (!result.contains("bodies")) return rows;
    for (const Json& body : result["bodies"]) {
        double squares = 0.0, points = 0.0, largest = 0.0;
        Json held_out;
        for (const Json& curve : body["curves"]) {
            if (!curve.contains("rms")) continue;
            const double max = curve["max"].get<double>();
            if (curve["held_out"].get<bool>()) {
                held_out = std::max(held_out.is_null() ? 0.0 : held_out.get<double>(), max);
                continue;
            }
            const auto count = static_cast<double>(curve["relative_density"].size());
            squares += count * std::pow(curve["rms"].get<double>(), 2);
            points += count;
            largest = std::max(largest, max);
        }
        const Json& constants = body["constants"];
        rows.push_back(
            {{"from", body["name"]},
             {"curves", body["curves"].size()},
             {"activation_energy", in_kilo(constants["activation_energy"])},
             {"material", body["material"]["name"]},
             {"error", error_cell(body)},
             {"prefactor", constants["prefactor"]},
             {"surface", constants.contains("surface_diffusion") ? constants["surface_diffusion"]["prefactor"] : Json()},
             {"rms", std::sqrt(squares / points)},
             {"max", largest},
             {"held_out", held_out}});
    }
    return rows;
}

/// Everything that is found, as one document.
Json found(const KineticsOptions& options, const Measured& measured, const std::vector<std::string>& files) {
    Json result{{"format", "dem-kinetics"}, {"version", io::format_version}, {"curves", curves_json(measured)}};
    const std::vector<double> densities = options.densities.empty() && !measured.fitted.empty()
                                              ? analysis::common_densities(measured.fitted, densities_by_default)
                                              : options.densities;
    result["model_free"] = model_free_json(measured.fitted, densities);
    if (files.empty()) return result;
    const auto material = options.material.empty() ? std::nullopt : std::optional(io::material_named(options.material));
    const std::vector<Body> bodies = read_bodies(files, material);
    if (bodies.empty()) throw Error("the files hold no history of a run");
    result.update(bodies_json(measured, bodies));
    result["material"] = result["bodies"][0]["material"];
    return result;
}

}  // namespace

int kinetics(int argc, char** argv) {
    cli::Common common;
    KineticsOptions options;
    CLI::App app{"Fits the kinetics of sintering to measured curves of density.", "analyze kinetics"};
    app.footer(kinetics_footer);
    options.add_to(app);
    common.add_to(app, true, false);
    cli::parse(app, argc, argv, common);
    options.check(app, common);
    cli::check_outputs({common.output, options.save_material});

    const Measured measured = options.read();
    Json result = found(options, measured, common.files);
    if (result["model_free"].is_null() && result.size() == 4) throw Error("no two measured curves pass one density");
    if (!common.quiet && result.contains("bodies"))
        for (const Json& body : result["bodies"])
            for (const Json& warning : body["warnings"])
                cli::warn("analyze kinetics", body["name"].get<std::string>() + ": " + warning.get<std::string>());
    if (!options.save_material.empty()) {
        io::Output file(options.save_material, true);
        file.write(result["material"]);
        file.commit();
    }
    Report report(common, options.table, kinetics_columns);
    if (options.table)
        for (Json& row : table_rows(result, measured.fitted.size())) report.add(std::move(row));
    else
        report.add(std::move(result));
    report.finish();
    return cli::done;
}

}  // namespace kiln::analyze
