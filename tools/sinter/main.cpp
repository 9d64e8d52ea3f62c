// main.cpp: `sinter` sinters packings of particles; `sinter green` makes them.
#include <CLI/CLI.hpp>
#include <optional>
#include <string_view>

#include "io/checkpoint.h"
#include "tools/common/material_option.h"
#include "tools/common/tool.h"
#include "green.h"
#include "run.h"

namespace {

using namespace kiln;

int sinter_states(int argc, char** argv) {
    CLI::App app("", "sinter");
    cli::Common common;
    sinter::Options options;
    options.add_to(app);
    cli::MaterialOption material;
    material.add_to(app);
    common.add_to(app);
    cli::parse(app, argc, argv, common);
    options.check(app, common.output);
    cli::check_outputs({common.output, options.history, options.checkpoint});

    const auto entry = [&](const Json& summary) { return cli::history_entry("sinter", app, summary); };
    io::CheckpointFile checkpoint(options.checkpoint, options.resume, options.checkpoint_every,
                                  options.bearing(entry(Json::object())["arguments"]));
    const std::optional<io::Checkpoint> earlier = checkpoint.read();
    if (earlier && earlier->run.finished) return sinter::finish(common.output, options.history, earlier->run, checkpoint);

    io::Input input(common.files);
    const auto resumption = [&](std::uint64_t io::RunState::*bytes) -> std::optional<io::Resumption> {
        if (!checkpoint.requested()) return std::nullopt;
        return io::Resumption{options.resume, earlier ? earlier->run.*bytes : 0};
    };
    io::Output states(common.output, common.text, resumption(&io::RunState::output_bytes));
    std::optional<io::Output> history;
    if (!options.history.empty()) history.emplace(options.history, true, resumption(&io::RunState::history_bytes));
    cli::Progress progress("sinter", common);
    const auto warn = [&](const std::string& sentence) {
        progress.clear();
        if (!common.quiet) cli::warn("sinter", sentence);
    };
    material.warn_by(warn);
    material.needed_for(options.uses());
    return sinter::run(input, material, options, {states, history ? &*history : nullptr, progress, entry, warn, checkpoint},
                       earlier);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc > 1 && std::string_view(argv[1]) == "green")
        return kiln::cli::run("sinter green", argc - 1, argv + 1, kiln::sinter::green);
    return kiln::cli::run("sinter", argc, argv, sinter_states);
}
