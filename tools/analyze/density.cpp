// density.cpp: density, coordination number, overlaps, sizes, clusters, texture and order of states.
#include <CLI/CLI.hpp>
#include <Eigen/Eigenvalues>
#include <algorithm>

#include "tools/common/quantity_options.h"
#include "tools/common/sizes.h"
#include "tools/common/value_options.h"
#include "io/material_io.h"
#include "io/state_io.h"
#include "tools/analyze/analyze.h"
#include "analysis/histogram.h"
#include "analysis/pair_correlation.h"
#include "tools/analyze/report.h"
#include "analysis/structure.h"

namespace kiln::analyze {

namespace {

constexpr const char* density_footer =
    "Keys of a result:\n"
    "  material                  its name, or names; null where the state does not say\n"
    "  time (s), temperature (K; null where the state has none), relative_density, particles\n"
    "  measure                   volume that the density refers to, see below\n"
    "  coordination_number       contacts per particle: overlaps, or bonds where there are some\n"
    "  mean_overlap_ratio        h/2R, or h/(r1 + r2) of unequal spheres; 0 for bonds of shrunk particles\n"
    "  overlap_ratio, diameter   {mean, standard_deviation, minimum, maximum}, diameter in m and with\n"
    "                            {by_number, by_volume} {d10, d50, d90}\n"
    "  mean_grain_diameter       mean diameter of the particles, m\n"
    "  mean_intercept            mean length of random lines in them, (4/3) sum r^3/sum r^2, m\n"
    "  neck_coverage             share of a particle's surface that is neck, sum a^2/(4 r^2), mean of all\n"
    "  vanished_grains, moved_by_surface, moved_by_boundary (m3)\n"
    "                            what coarsening did in the last run of sinter, where there was any\n"
    "  clusters                  groups that contacts connect, single particles included\n"
    "  largest_cluster_fraction  of the particles\n"
    "  isolated                  particles without a contact\n"
    "  fabric_tensor             mean of n n over the directions n of the contacts; 1/3 on the diagonal\n"
    "                            without texture\n"
    "  fabric_anisotropy         its largest less its smallest principal value\n"
    "  probe_radius              m, with --measure envelope\n"
    "  diameter_histogram, overlap_histogram\n"
    "                            with --bins {edges, counts}\n"
    "  pair_correlation          with --correlation {distance (m), g, centres}\n\n"
    "Volumes:\n"
    "  box       of a periodic state\n"
    "  inner     of a state with a free axis: between the outermost centres, one mean diameter inwards;\n"
    "            a particle counts if its centre is inside, with half of each of its bonds\n"
    "  envelope  what a ball rolling over the outside cannot enter, as grains of an envelope pycnometer\n"
    "            (its radius: probe_radius, m)\n"
    "  none      the body is too small for that, and relative_density is null\n\n"
    "Examples:\n"
    "  analyze density --table sintered.kiln\n"
    "  analyze density --measure envelope free.kiln\n"
    "  analyze density --correlation sintered.kiln | jq .pair_correlation.g\n"
    "  sinter --temperature 1200C --every 10s --at-time 1min green.kiln | analyze density |\n"
    "      jq -r '[.time, .relative_density] | @tsv'";

const std::vector<Column> density_columns{{"material", "material", ""},
                                  {"time", "time", "s"},
                                  {"temperature", "temperature", "K"},
                                  {"relative_density", "relative density", ""},
                                  {"measure", "measure", ""},
                                  {"particles", "particles", ""},
                                  {"coordination_number", "coordination number", ""},
                                  {"mean_overlap_ratio", "mean overlap h/2R", ""},
                                  {"largest_cluster_fraction", "largest cluster", ""},
                                  {"fabric_anisotropy", "anisotropy", ""},
                                  {"mean_grain_diameter", "mean diameter", "m"},
                                  {"mean_intercept", "mean intercept", "m"},
                                  {"neck_coverage", "coverage", ""}};

struct DensityOptions {
    analysis::Measure measure = analysis::Measure::automatic;
    double probe = 0.0;  // m; 0: the mean diameter
    std::size_t bins = 0;
    bool correlation = false;
    double range = 0.0;  // m; 0: four mean diameters
    std::size_t correlation_bins = 100;

    void add_to(CLI::App& app) {
        cli::add_choice(app, "--measure", measure,
                        {{"auto", analysis::Measure::automatic},
                         {"box", analysis::Measure::box},
                         {"inner", analysis::Measure::inner},
                         {"envelope", analysis::Measure::envelope}},
                        "Volume that the density refers to; auto: box for a periodic state, else inner");
        cli::add_quantity(app, "--probe-radius", probe, io::Dimension::length, "Radius of the ball that rolls over the envelope",
                          "the mean diameter");
        cli::add_number(app, "--bins", bins, {1, 1000000}, "Also histograms of diameters and overlaps, with so many bins")
            ->default_str("");
        auto* wanted = app.add_flag("--correlation", correlation, "Also the pair correlation function g(r)");
        cli::add_quantity(app, "--range", range, io::Dimension::length, "Largest distance of g(r)", "four mean diameters")
            ->needs(wanted);
        cli::add_number(app, "--shells", correlation_bins, {1, 1000000}, "Number of shells of g(r)")->needs(wanted);
        app.callback([this, &app] {
            for (const char* name : {"--probe-radius", "--range"})
                if (app.count(name) > 0 && !((name[2] == 'p' ? probe : range) > 0.0))
                    throw CLI::ValidationError(name, "must be greater than zero");
            if (app.count("--probe-radius") > 0 && measure != analysis::Measure::envelope)
                throw CLI::ValidationError("--probe-radius", "needs --measure envelope");
            refuse_with_table(app, {"--bins", "--correlation"});
        });
    }
};

void add_contacts(Json& result, const State& state, std::size_t bins) {
    const std::vector<Pair> contacts = analysis::contacts_of(state);
    const std::size_t particles = state.particles.size();
    const auto count = static_cast<double>(particles);
    const std::vector<double> overlaps = analysis::overlap_ratios(state, contacts);
    const std::vector<std::size_t> clusters = analysis::cluster_sizes(particles, contacts);
    const Eigen::Matrix3d fabric = analysis::fabric_tensor(state, contacts);
    const Vec3 principal = fabric.selfadjointView<Eigen::Lower>().eigenvalues();
    const Json overlap = spread_json(analysis::spread_of(overlaps));
    result["coordination_number"] = particles == 0 ? 0.0 : 2.0 * static_cast<double>(contacts.size()) / count;
    result["mean_overlap_ratio"] = overlap.is_null() ? Json(0.0) : overlap["mean"];
    result["overlap_ratio"] = overlap;
    result["clusters"] = clusters.size();
    result["largest_cluster_fraction"] = clusters.empty() ? 0.0 : static_cast<double>(clusters.front()) / count;
    std::vector<char> touched(particles);
    for (const Pair& pair : contacts) touched[static_cast<std::size_t>(pair.i)] = touched[static_cast<std::size_t>(pair.j)] = 1;
    result["isolated"] = std::ranges::count(touched, 0);
    result["fabric_tensor"] = Json::array();
    for (int row = 0; row < 3; ++row) result["fabric_tensor"].push_back({fabric(row, 0), fabric(row, 1), fabric(row, 2)});
    result["fabric_anisotropy"] = principal.maxCoeff() - principal.minCoeff();
    if (bins > 0) result["overlap_histogram"] = histogram_json(analysis::histogram_of(overlaps, bins, 0.0));
}

void add_grains(Json& result, const State& state) {
    const physics::GrainSize size = analysis::grain_size(state);
    result["mean_grain_diameter"] = size.mean_diameter;
    result["mean_intercept"] = size.mean_intercept;
    result["neck_coverage"] = size.coverage;
    const Json history = io::history_of(state);
    for (auto entry = history.rbegin(); entry != history.rend(); ++entry) {
        if (!entry->is_object() || entry->value("tool", Json()) != "sinter" || !entry->contains("summary")) continue;
        for (const char* key : {"vanished_grains", "moved_by_surface", "moved_by_boundary"})
            if ((*entry)["summary"].contains(key)) result[key] = (*entry)["summary"][key];
        break;
    }
}

Json density_of(const State& state, const DensityOptions& options) {
    const analysis::Density density = analysis::measured_density(state, options.measure, options.probe);
    Json result{{"format", "dem-density"},
                {"version", io::format_version},
                {"material", io::material_names(state)},
                {"time", state.time},
                {"temperature", state.temperature ? Json(*state.temperature) : Json()},
                {"relative_density", density.value ? Json(*density.value) : Json()},
                {"measure", density.measure},
                {"particles", state.particles.size()}};
    if (density.measure == "envelope")
        result["probe_radius"] = options.probe > 0.0 ? options.probe : analysis::mean_diameter(state.particles);
    add_contacts(result, state, options.bins);
    add_grains(result, state);
    std::vector<double> diameters;
    for (const double radius : state.particles.radius) diameters.push_back(2.0 * radius);
    result["diameter"] = spread_json(analysis::spread_of(diameters));
    if (!diameters.empty()) result["diameter"].update(cli::percentiles_json(diameters));
    if (options.bins > 0) result["diameter_histogram"] = histogram_json(analysis::histogram_of(diameters, options.bins, 0.0));
    if (options.correlation && state.particles.size() > 0) {
        const double range = options.range > 0.0 ? options.range : 4.0 * analysis::mean_diameter(state.particles);
        const analysis::PairCorrelation found = analysis::pair_correlation(state, range, options.correlation_bins);
        result["pair_correlation"] = {{"distance", found.distance}, {"g", found.g}, {"centres", found.centres}};
    }
    return result;
}

}  // namespace

int density(int argc, char** argv) {
    DensityOptions options;
    CLI::App app{"Density, coordination number, overlaps, sizes, clusters and texture of every state.", "analyze density"};
    app.footer(density_footer);
    options.add_to(app);
    return report_each(app, argc, argv, density_columns, [&](io::Document document) {
        return density_of(io::state_from(std::move(document)), options);
    });
}

}  // namespace kiln::analyze
