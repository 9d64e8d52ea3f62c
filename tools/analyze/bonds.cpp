// bonds.cpp: number and mean size of the bonds of states, and the distribution of their radii.
#include <algorithm>
#include <numeric>

#include "io/state_io.h"
#include "tools/analyze/analyze.h"
#include "tools/analyze/report.h"
#include "tools/analyze/structure.h"

namespace kiln::analyze {

namespace {

constexpr const char* footer =
    "Keys: relative_density, particles, count, mean_diameter (m), mean_length (m), bond_volume_fraction (share of the solid "
    "that is in bonds), histogram of the radii {edges (m), counts}.\n"
    "Examples:\n"
    "  analyze bonds --table bonded.kiln\n"
    "  bondify sintered.kiln | analyze bonds --bins 50 | jq .histogram";

const std::vector<Column> columns{{"relative_density", "relative density", ""}, {"particles", "particles", ""},
                                  {"count", "bonds", ""},                       {"mean_diameter", "mean diameter", "m"},
                                  {"mean_length", "mean length", "m"},          {"bond_volume_fraction", "bond share", ""}};

double sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

/// Bins of equal width from zero to the largest radius, which belongs to the last one.
Json histogram_of(const std::vector<double>& radius, std::size_t bins) {
    const double width = radius.empty() ? 0.0 : std::ranges::max(radius) / static_cast<double>(bins);
    std::vector<double> edges(bins + 1);
    for (std::size_t edge = 0; edge <= bins; ++edge) edges[edge] = static_cast<double>(edge) * width;
    std::vector<std::size_t> counts(bins);
    for (const double r : radius) ++counts[width > 0.0 ? std::min(static_cast<std::size_t>(r / width), bins - 1) : 0];
    return {{"edges", edges}, {"counts", counts}};
}

Json bonds_of(const State& state, const std::string& place, std::size_t bins) {
    if (!state.bonds) throw Error(place + ": has no bonds; bondify makes them");
    const Density density = measured_density(state);
    const auto mean = [](const std::vector<double>& values) {
        return values.empty() ? Json() : Json(sum(values) / static_cast<double>(values.size()));
    };
    const Bonds& bonds = *state.bonds;
    const double in_bonds = sum(bonds.volume);
    Json diameter = mean(bonds.radius);
    if (!diameter.is_null()) diameter = 2.0 * diameter.get<double>();
    return {{"format", "dem-bonds"},
            {"version", io::format_version},
            {"time", state.time},
            {"relative_density", density.value ? Json(*density.value) : Json()},
            {"particles", state.particles.size()},
            {"count", bonds.size()},
            {"mean_diameter", diameter},
            {"mean_length", mean(bonds.length)},
            {"bond_volume_fraction", bonds.size() == 0 ? 0.0 : in_bonds / (in_bonds + particle_volume(state.particles))},
            {"histogram", histogram_of(bonds.radius, bins)}};
}

}  // namespace

int bonds(int argc, char** argv) {
    std::size_t bins = 20;
    CLI::App app{"Number, mean diameter and mean length of the bonds of every state, and the distribution of their radii.",
                 "analyze bonds"};
    app.footer(footer);
    app.add_option("--bins", bins, "number of bins of the histogram")->check(CLI::Range(1, 1000000))->capture_default_str();
    return report_each(app, argc, argv, columns, [&bins](io::Document document) {
        const std::string place = document.place;
        return bonds_of(io::state_from(std::move(document)), place, bins);
    });
}

}  // namespace kiln::analyze
