// green.cpp: `sinter green`: parse, pack, write.
#include "tools/sinter/green.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>

#include "analysis/histogram.h"
#include "analysis/structure.h"
#include "packing/sphere_list.h"
#include "tools/common/each_state.h"
#include "tools/common/progress.h"
#include "tools/common/sizes.h"
#include "core/contacts.h"
#include "io/files.h"
#include "io/state_io.h"
#include "tools/sinter/green_options.h"
#include "io/material_check.h"
#include "io/material_io.h"

namespace kiln::sinter {

using packing::Method, packing::PackingOptions, packing::Relaxation, packing::RelaxationOptions, packing::Weighting;

namespace {

constexpr int steps_between_details = 10;
constexpr double worth_warning = 0.1;  // relative deviation of the median by volume from the one asked for

/// Shows how far a relaxation has come: overlaps fall roughly exponentially.
void show(cli::Progress& progress, const Relaxation& relaxation) {
    const double end = RelaxationOptions().max_overlap;
    const double now = std::clamp(relaxation.max_overlap, end, 1.0);
    progress.show(std::log(now) / std::log(end), "relaxing, " + std::to_string(relaxation.contacts) + " overlaps");
    if (relaxation.steps % steps_between_details == 0)
        progress.detail({{"step", relaxation.steps},
                         {"overlaps", relaxation.contacts},
                         {"largest_overlap_ratio", relaxation.max_overlap},
                         {"mean_overlap_ratio", relaxation.mean_overlap}});
}

std::string name_of(Method method) {
    switch (method) {
        case Method::loose:
            return "loose";
        case Method::affine:
            return "affine";
        case Method::soft:
            return "soft";
    }
    throw std::logic_error("method without a name");
}

std::vector<double> diameters_of(const State& state) {
    std::vector<double> diameters;
    for (const double radius : state.particles.radius) diameters.push_back(2.0 * radius);
    return diameters;
}

Json made_sizes(const State& state) {
    const std::vector<double> diameters = diameters_of(state);
    Json made = cli::percentiles_json(diameters);
    const analysis::Spread spread = *analysis::spread_of(diameters);
    made["mean"] = spread.mean;
    made["minimum"] = spread.minimum;
    made["maximum"] = spread.maximum;
    return made;
}

Json asked_sizes(const packing::SizeDistribution& distribution) {
    return cli::percentiles_json([&](double fraction, bool by_volume) {
        return packing::size_quantile(distribution, fraction, by_volume ? Weighting::volume : Weighting::number);
    });
}

/// Three digits and a prefix: 104 nm.
std::string length_text(double length) {
    const auto [factor, unit] = length < 1e-6 ? std::pair(1e9, "nm") : length < 1e-3 ? std::pair(1e6, "um") : std::pair(1e3, "mm");
    char text[32];
    std::snprintf(text, sizeof text, "%.3g %s", factor * length, unit);
    return text;
}

/// "diameters by volume: D10 102 nm (asked for 100 nm), …".
std::string sizes_text(const Json& sizes, const char* by, const std::string& name) {
    std::string text = "diameters by " + name + ": ";
    for (const char* key : {"d10", "d50", "d90"})
        text += std::string(key == std::string("d10") ? "D" : ", D") + (key + 1) + " " +
                length_text(sizes["made"][by][key].get<double>()) + " (asked for " +
                length_text(sizes["asked"][by][key].get<double>()) + ")";
    return text;
}

/// Says what sizes came out; warns where the particles are too few to show the distribution.
void report_sizes(const Json& sizes) {
    for (const auto& [by, name] : {std::pair("by_number", "number"), std::pair("by_volume", "volume")})
        std::cerr << "sinter green: " << sizes_text(sizes, by, name) << "\n";
    const double asked = sizes["asked"]["by_volume"]["d50"].get<double>(), made = sizes["made"]["by_volume"]["d50"].get<double>();
    if (std::abs(made - asked) > worth_warning * asked)
        cli::warn("sinter green", "half of the volume lies below " + length_text(made) + ", not below the " + length_text(asked) +
                                      " of the distribution: large particles are so rare that more are needed to show it (-n)");
}

Json summary_of(const PackingOptions& options, const State& state) {
    const std::vector<Pair> pairs = find_pairs(state.box, state.particles.position, state.particles.radius);
    const ContactStatistics contacts = contact_statistics(state.box, state.particles, pairs);
    return {{"method", name_of(options.method)},
            {"seed", options.seed},
            {"coordination_number", contacts.coordination_number},
            {"mean_overlap_ratio", contacts.mean_overlap_ratio},
            {"relative_density", relative_density(state)},
            {"diameters", {{"asked", asked_sizes(options.distribution)}, {"made", made_sizes(state)}}}};
}

/// What is to be known of spheres that came from elsewhere.
Json summary_of_spheres(const State& state) {
    const packing::Overlaps overlaps = packing::overlaps_of(state);
    const analysis::Density density = analysis::measured_density(state);
    return {{"method", "spheres"},
            {"contacts", overlaps.contacts},
            {"coordination_number", 2.0 * static_cast<double>(overlaps.contacts) / static_cast<double>(state.particles.size())},
            {"mean_overlap_ratio", overlaps.mean},
            {"largest_overlap_ratio", overlaps.max},
            {"relative_density", density.value ? Json(*density.value) : Json()},
            {"measure", density.measure},
            {"diameters", {{"made", made_sizes(state)}}}};
}

void report_spheres(const Json& summary, std::size_t spheres) {
    const auto text = [&](const char* key) { return Json(std::round(1e4 * summary[key].get<double>()) / 1e4).dump(); };
    std::cerr << "sinter green: " << spheres << " spheres, " << text("coordination_number")
              << " contacts each, overlap h/(r1 + r2) " << text("mean_overlap_ratio") << " in the mean and "
              << text("largest_overlap_ratio") << " at most\n";
    if (summary["contacts"] == 0)
        cli::warn("sinter green", "no spheres touch; --swell brings them together by a fraction of their distances");
}

/// What is wrong with a material, and what it cannot be used for, before anything is made of it.
void report_material(const Material& material, bool of_file) {
    using physics::Use;
    const auto warn = [](const std::string& sentence) { cli::warn("sinter green", sentence); };
    const std::vector<Use> all{Use::sintering, Use::surface_coarsening, Use::boundary_coarsening, Use::elasticity, Use::inertia};
    for (const std::string& sentence : io::unknown_keys(material)) warn(sentence);
    for (const std::string& sentence : io::implausible_constants(material, all)) warn(sentence);
    const std::string missing = io::missing_sentence(material, of_file ? all : std::vector<Use>{Use::sintering, Use::elasticity});
    if (!missing.empty()) warn(missing);
}

State spheres_of(const GreenOptions& options) {
    const packing::SphereList spheres = packing::read_spheres(options.spheres, options.manner);
    return cli::at_place(options.spheres, [&] { return packing::body_of(spheres, options.body); });
}

}  // namespace

int green(int argc, char** argv) {
    CLI::App app("", "sinter green");
    GreenOptions options;
    options.add_to(app);
    cli::parse(app, argc, argv, options.common);
    options.complete(app);
    const Material material = io::material_named(options.material);
    if (!options.common.quiet) report_material(material, options.material.ends_with(".json"));
    io::Output output(options.common.output, options.common.text);

    State state;
    Json summary;
    if (!options.spheres.empty()) {
        state = spheres_of(options);
        summary = summary_of_spheres(state);
        if (!options.common.quiet) report_spheres(summary, state.particles.size());
    } else {
        cli::Progress progress("sinter green", options.common);
        state =
            packing::pack(options.packing, cli::stop_requested, [&](const Relaxation& relaxation) { show(progress, relaxation); });
        progress.clear();
        summary = summary_of(options.packing, state);
        if (options.distribution != "monosize" && !options.common.quiet) report_sizes(summary["diameters"]);
    }
    state.materials = {material};
    io::append_history(state, cli::history_entry("sinter green", app, summary));
    output.write(std::move(state));
    output.commit();
    return cli::done;
}

}  // namespace kiln::sinter
