// run.h: sinters every state of a stream through all required densities and times.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "tools/common/material_option.h"
#include "tools/common/progress.h"
#include "io/checkpoint.h"
#include "io/files.h"
#include "options.h"

namespace kiln::sinter {

/// Where results go, and who is told on the way.
struct Sinks {
    io::Output& states;
    io::Output* history;  // or nothing
    cli::Progress& progress;
    std::function<Json(const Json& summary)> entry;       // history entry of a state from its summary
    std::function<void(const std::string& sentence)> warn;
    io::CheckpointFile& checkpoint;
};

/// Sinters the states of the input, or what an earlier run left of them, and writes a state at each required density and time, in
/// the order in which they are reached. Gives the exit status: 3 if a step did not converge or the schedule ended short of a
/// required density. A requested stop ends the run after its step: with the last state written, or in a checkpoint if there is
/// one. Throws Error for a required density or time that lies behind the state.
int run(io::Input& input, const cli::MaterialOption& material, const Options& options, const Sinks& sinks,
        const std::optional<io::Checkpoint>& earlier);

/// The end of a run whose checkpoint says that only the renaming of its outputs was left.
int finish(const std::string& output, const std::string& history, const io::RunState& run_state,
           const io::CheckpointFile& checkpoint);

}  // namespace kiln::sinter
