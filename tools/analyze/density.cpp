// density.cpp: density, coordination number, overlaps, sizes, clusters, texture and order of states.
#include <CLI/CLI.hpp>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <map>

#include "tools/common/quantity_options.h"
#include "io/state_io.h"
#include "tools/analyze/analyze.h"
#include "analysis/histogram.h"
#include "analysis/pair_correlation.h"
#include "tools/analyze/report.h"
#include "analysis/structure.h"

namespace kiln::analyze {

namespace {

constexpr const char* footer =
    "Keys: time (s), relative_density, measure, particles, coordination_number (contacts per particle), mean_overlap_ratio (h/2R, "
    "or h/(r1 + r2) for unequal spheres), overlap_ratio and diameter (m) {mean, standard_deviation, minimum, maximum}, "
    "clusters (groups that hang together, single particles included), largest_cluster_fraction, isolated (particles without a "
    "contact), "
    "fabric_tensor (mean of n n over the directions n of the contacts; 1/3 on the diagonal without texture), fabric_anisotropy "
    "(largest "
    "less smallest principal value). Contacts are overlaps, or the bonds of a state that has them (overlap 0).\n"
    "With --bins: diameter_histogram, overlap_histogram {edges, counts}. With --correlation: pair_correlation {distance (m), g, "
    "centres}.\n"
    "measure says which volume the density refers to. box: of a periodic state. inner, for a state with a free axis: between the "
    "outermost centres, one mean diameter inwards; a particle counts if its centre is inside, with half of each of its bonds. "
    "envelope: what a ball rolling over the outside cannot enter, as grains of an envelope pycnometer (its radius: probe_radius, "
    "m). "
    "none: the body is too small for that, and relative_density is null.\n"
    "Examples:\n"
    "  analyze density --table sintered.kiln\n"
    "  analyze density --measure envelope free.kiln\n"
    "  analyze density --correlation sintered.kiln | jq .pair_correlation.g\n"
    "  sinter green.kiln --every 10s | analyze density | jq -r '[.time, .relative_density] | @tsv'";

const std::vector<Column> columns{{"time", "time", "s"},
                                  {"relative_density", "relative density", ""},
                                  {"measure", "measure", ""},
                                  {"particles", "particles", ""},
                                  {"coordination_number", "coordination number", ""},
                                  {"mean_overlap_ratio", "mean overlap h/2R", ""},
                                  {"largest_cluster_fraction", "largest cluster", ""},
                                  {"fabric_anisotropy", "anisotropy", ""}};

struct Options {
    analysis::Measure measure = analysis::Measure::automatic;
    double probe = 0.0;  // m; 0: the mean diameter
    std::size_t bins = 0;
    bool correlation = false;
    double range = 0.0;  // m; 0: four mean diameters
    std::size_t correlation_bins = 100;

    void add_to(CLI::App& app) {
        static const std::map<std::string, analysis::Measure> measures{{"auto", analysis::Measure::automatic},
                                                                       {"box", analysis::Measure::box},
                                                                       {"inner", analysis::Measure::inner},
                                                                       {"envelope", analysis::Measure::envelope}};
        app.add_option_function<std::string>(
               "--measure", [this](const std::string& name) { measure = measures.at(name); },
               "volume that the density refers to; auto: box for a periodic state, else inner")
            ->check(CLI::IsMember(measures))
            ->default_str("auto");
        cli::add_quantity(app, "--probe-radius", probe, io::Dimension::length, "radius of the ball that feels the envelope",
                          "the mean diameter");
        app.add_option("--bins", bins, "also histograms of diameters and overlaps, with so many bins")
            ->check(CLI::Range(1, 1000000));
        auto* wanted = app.add_flag("--correlation", correlation, "also the pair correlation function g(r)");
        cli::add_quantity(app, "--range", range, io::Dimension::length, "largest distance of g(r)", "four mean diameters")
            ->needs(wanted);
        app.add_option("--shells", correlation_bins, "number of shells of g(r)")
            ->check(CLI::Range(1, 1000000))
            ->capture_default_str()
            ->needs(wanted);
        app.callback([this, &app] {
            for (const char* name : {"--probe-radius", "--range"})
                if (app.count(name) > 0 && !((name[2] == 'p' ? probe : range) > 0.0))
                    throw CLI::ValidationError(name, "must be greater than zero");
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
    const Json overlap = analysis::spread_of(overlaps);
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
    if (bins > 0) result["overlap_histogram"] = analysis::histogram_of(overlaps, bins, 0.0);
}

Json density_of(const State& state, const Options& options) {
    const analysis::Density density = analysis::measured_density(state, options.measure, options.probe);
    Json result{{"format", "dem-density"},
                {"version", io::format_version},
                {"time", state.time},
                {"relative_density", density.value ? Json(*density.value) : Json()},
                {"measure", density.measure},
                {"particles", state.particles.size()}};
    if (density.measure == "envelope")
        result["probe_radius"] = options.probe > 0.0 ? options.probe : analysis::mean_diameter(state.particles);
    add_contacts(result, state, options.bins);
    std::vector<double> diameters;
    for (const double radius : state.particles.radius) diameters.push_back(2.0 * radius);
    result["diameter"] = analysis::spread_of(diameters);
    if (options.bins > 0) result["diameter_histogram"] = analysis::histogram_of(diameters, options.bins, 0.0);
    if (options.correlation && state.particles.size() > 0) {
        const double range = options.range > 0.0 ? options.range : 4.0 * analysis::mean_diameter(state.particles);
        const analysis::PairCorrelation found = analysis::pair_correlation(state, range, options.correlation_bins);
        result["pair_correlation"] = {{"distance", found.distance}, {"g", found.g}, {"centres", found.centres}};
    }
    return result;
}

}  // namespace

int density(int argc, char** argv) {
    Options options;
    CLI::App app{"Density, coordination number, overlaps, sizes, clusters and texture of every state.", "analyze density"};
    app.footer(footer);
    options.add_to(app);
    return report_each(app, argc, argv, columns, [&](io::Document document) {
        const std::string place = document.place;
        try {
            return density_of(io::state_from(std::move(document)), options);
        } catch (const Error& error) {
            if (std::string(error.what()).starts_with(place)) throw;
            throw Error(place + ": " + error.what());
        }
    });
}

}  // namespace kiln::analyze
