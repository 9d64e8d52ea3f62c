// density.cpp: density, coordination number, overlaps and clusters of states.
#include "io/state_io.h"
#include "tools/analyze/analyze.h"
#include "tools/analyze/report.h"
#include "tools/analyze/structure.h"

namespace kiln::analyze {

namespace {

constexpr const char* footer =
    "Keys: time (s), relative_density, measure, particles, coordination_number (contacts per particle), mean_overlap_ratio (h/2R, "
    "or h/(r1 + r2) for unequal spheres), largest_cluster_fraction. Contacts are overlaps, or the bonds of "
    "a state that has them (overlap 0).\n"
    "measure says which volume the density refers to. box: of a periodic state. inner, for a state with a free axis: between the "
    "outermost centres, one mean diameter inwards; a particle counts if its centre is inside, with half of each of its bonds. "
    "none: the body is too small for that, and relative_density is null.\n"
    "Examples:\n"
    "  analyze density --table sintered.kiln\n"
    "  sinter green.kiln --every 10s | analyze density | jq -r '[.time, .relative_density] | @tsv'";

const std::vector<Column> columns{{"time", "time", "s"},
                                  {"relative_density", "relative density", ""},
                                  {"measure", "measure", ""},
                                  {"particles", "particles", ""},
                                  {"coordination_number", "coordination number", ""},
                                  {"mean_overlap_ratio", "mean overlap h/2R", ""},
                                  {"largest_cluster_fraction", "largest cluster", ""}};

Json density_of(const State& state) {
    const Density density = measured_density(state);
    const std::vector<Pair> contacts = contacts_of(state);
    const std::size_t particles = state.particles.size();
    const double ends = 2.0 * static_cast<double>(contacts.size());
    return {{"format", "dem-density"},
            {"version", io::format_version},
            {"time", state.time},
            {"relative_density", density.value ? Json(*density.value) : Json()},
            {"measure", density.measure},
            {"particles", particles},
            {"coordination_number", particles == 0 ? 0.0 : ends / static_cast<double>(particles)},
            {"mean_overlap_ratio", mean_overlap_ratio(state, contacts)},
            {"largest_cluster_fraction", largest_cluster_fraction(particles, contacts)}};
}

}  // namespace

int density(int argc, char** argv) {
    CLI::App app{"Density, coordination number, overlaps and clusters of every state.", "analyze density"};
    app.footer(footer);
    return report_each(app, argc, argv, columns, [](io::Document document) { return density_of(io::state_from(std::move(document))); });
}

}  // namespace kiln::analyze
