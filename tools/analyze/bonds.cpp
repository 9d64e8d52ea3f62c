// bonds.cpp: number and mean size of the bonds of states, and the distribution of their radii.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "io/material_io.h"
#include "io/state_io.h"
#include "physics/bond_stress.h"
#include "tools/analyze/analyze.h"
#include "analysis/histogram.h"
#include "tools/analyze/report.h"
#include "tools/common/value_options.h"
#include "analysis/structure.h"

namespace kiln::analyze {

namespace {

constexpr const char* bonds_footer =
    "Keys of a result:\n"
    "  material, time (s)    of the state\n"
    "  relative_density, particles, count, mean_diameter (m), mean_length (m)\n"
    "  bond_volume_fraction  of the solid; 0 for necks, whose solid is counted with the particles\n"
    "  clamped_percent, lost_percent, dropped_percent, limited_percent\n"
    "                        of bondify: clamped bonds; of the volume of all bonds, what these cannot\n"
    "                        hold (which lowers E by a fifth to a third of that) and what --drop-thin\n"
    "                        left out; limited necks\n"
    "  histogram             of the radii {edges (m), counts}\n"
    "of bonds that carry forces, as in the states that bend writes, also, tension positive\n"
    "  normal_force, normal_stress, fibre_stress\n"
    "                        {mean, standard_deviation, minimum, maximum}, N and Pa: along the bond; over\n"
    "                        its section; with the moment as if it only bent the bond\n"
    "  compressed_fraction   of the bonds\n"
    "  force_histogram       {edges (N), counts}\n\n"
    "Examples:\n"
    "  analyze bonds --table bonded.kiln\n"
    "  bondify sintered.kiln | analyze bonds --bins 50 | jq .histogram";

const std::vector<Column> bonds_columns{{"material", "material", ""},
                                        {"relative_density", "relative density", ""},
                                        {"particles", "particles", ""},
                                        {"count", "bonds", ""},
                                        {"mean_diameter", "mean diameter", "m"},
                                        {"mean_length", "mean length", "m"},
                                        {"bond_volume_fraction", "bond fraction", ""},
                                        {"clamped_percent", "clamped, %", ""},
                                        {"lost_percent", "volume lost, %", ""}};

double sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

/// The column of that name as numbers; nothing unless it is f8 with so many values a row.
const std::vector<double>* column(const Bonds& bonds, const std::string& name, std::size_t row_length) {
    const auto found = std::ranges::find(bonds.other, name, &NamedArray::name);
    if (found == bonds.other.end() || found->array.row_length() != row_length) return nullptr;
    return std::get_if<std::vector<double>>(&found->array.data);
}

/// Force along each bond, and the greatest stress in its section, as far as the bonds carry forces and moments.
void add_loads(Json& result, const Bonds& bonds, std::size_t bins) {
    const std::vector<double>* force = column(bonds, "normal_force", 1);
    if (!force || force->empty()) return;
    const std::vector<double>* moment = column(bonds, "moment", 3);
    std::vector<double> stress, fibre;
    for (std::size_t bond = 0; bond < bonds.size(); ++bond) {
        const double tension = (*force)[bond], radius = bonds.radius[bond];
        if (radius == 0.0) continue;
        stress.push_back(physics::bond_stress(tension, 0.0, 0.0, 0.0, radius).tensile);
        if (!moment) continue;
        const double* turn = moment->data() + 3 * bond;
        fibre.push_back(physics::bond_stress(tension, 0.0, std::hypot(turn[0], turn[1], turn[2]), 0.0, radius).tensile);
    }
    result["normal_force"] = spread_json(analysis::spread_of(*force));
    result["compressed_fraction"] = static_cast<double>(std::ranges::count_if(*force, [](double f) { return f < 0.0; })) /
                                    static_cast<double>(force->size());
    result["normal_stress"] = spread_json(analysis::spread_of(stress));
    if (moment) result["fibre_stress"] = spread_json(analysis::spread_of(fibre));
    result["force_histogram"] = histogram_json(analysis::histogram_of(*force, bins, std::ranges::min(*force)));
}

/// What the bonds could not hold, as the last bondify said; null where it did not.
void add_losses(Json& result, const Json& history) {
    const auto keys = {"clamped_percent", "lost_percent", "dropped_percent", "limited_percent"};
    for (const char* key : keys) result[key] = nullptr;
    for (auto entry = history.rbegin(); entry != history.rend(); ++entry) {
        if (!entry->is_object() || entry->value("tool", Json()) != "bondify" || !entry->contains("summary")) continue;
        for (const char* key : keys)
            if ((*entry)["summary"].contains(key)) result[key] = (*entry)["summary"][key];
        return;
    }
}

Json bonds_of(const State& state, std::size_t bins) {
    if (!state.bonds) throw Error("has no bonds; bondify makes them");
    const analysis::Density density = analysis::measured_density(state);
    const auto mean = [](const std::vector<double>& values) {
        return values.empty() ? Json() : Json(sum(values) / static_cast<double>(values.size()));
    };
    const Bonds& bonds = *state.bonds;
    const double in_bonds = sum(bonds.volume);
    Json diameter = mean(bonds.radius);
    if (!diameter.is_null()) diameter = 2.0 * diameter.get<double>();
    Json result{{"format", "dem-bonds"},
                {"version", io::format_version},
                {"material", io::material_names(state)},
                {"time", state.time},
                {"relative_density", density.value ? Json(*density.value) : Json()},
                {"particles", state.particles.size()},
                {"count", bonds.size()},
                {"mean_diameter", diameter},
                {"mean_length", mean(bonds.length)},
                {"bond_volume_fraction", bonds.size() == 0 ? 0.0 : in_bonds / (in_bonds + particle_volume(state.particles))},
                {"histogram", histogram_json(analysis::histogram_of(bonds.radius, bins, 0.0))}};
    add_losses(result, io::history_of(state));
    add_loads(result, bonds, bins);
    return result;
}

}  // namespace

int bonds(int argc, char** argv) {
    std::size_t bins = 20;
    CLI::App app{"Counts and measures the bonds of every state.",
                 "analyze bonds"};
    app.footer(bonds_footer);
    cli::add_number(app, "--bins", bins, {1, 1000000}, "Number of bins of the histogram");
    app.callback([&app] { refuse_with_table(app, {"--bins"}); });
    return report_each(app, argc, argv, bonds_columns, [&bins](io::Document document) {
        return bonds_of(io::state_from(std::move(document)), bins);
    });
}

}  // namespace kiln::analyze
