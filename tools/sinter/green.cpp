// green.cpp: `sinter green`: parse, pack, write.
#include "tools/sinter/green.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <fstream>

#include "tools/common/progress.h"
#include "core/contacts.h"
#include "io/files.h"
#include "io/state_io.h"
#include "physics/materials.h"
#include "tools/sinter/green_options.h"
#include "io/material_io.h"

namespace kiln::sinter {

using packing::Method, packing::PackingOptions, packing::Relaxation, packing::RelaxationOptions;

namespace {

constexpr int steps_between_details = 10;

Material material_named(const std::string& name) {
    if (!name.ends_with(".json")) return physics::builtin_material(name);
    std::ifstream file(name);
    if (!file) throw Error(name + ": the material cannot be read");
    const Json json = Json::parse(file, nullptr, false);
    if (json.is_discarded()) throw Error(name + ": is not JSON");
    return io::material_from(json, name);
}

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

Json summary_of(const PackingOptions& options, const State& state) {
    const std::vector<Pair> pairs = find_pairs(state.box, state.particles.position, state.particles.radius);
    const ContactStatistics contacts = contact_statistics(state.box, state.particles, pairs);
    return {{"method", name_of(options.method)},
            {"seed", options.seed},
            {"coordination_number", contacts.coordination_number},
            {"mean_overlap_ratio", contacts.mean_overlap_ratio},
            {"relative_density", relative_density(state)}};
}

}  // namespace

int green(int argc, char** argv) {
    CLI::App app("", "sinter green");
    GreenOptions options;
    options.add_to(app);
    cli::parse(app, argc, argv, options.common);
    options.complete(app);
    const Material material = material_named(options.material);
    io::Output output(options.common.output, options.common.text);

    cli::Progress progress("sinter green", options.common);
    State state =
        packing::pack(options.packing, cli::stop_requested, [&](const Relaxation& relaxation) { show(progress, relaxation); });
    progress.clear();
    state.materials = {material};
    io::append_history(state, cli::history_entry("sinter green", app, summary_of(options.packing, state)));
    output.write(std::move(state));
    output.commit();
    return cli::done;
}

}  // namespace kiln::sinter
