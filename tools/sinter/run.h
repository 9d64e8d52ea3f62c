// run.h: sinters one state through all wanted densities and times.
#pragma once

#include <functional>
#include <string>

#include "cli/progress.h"
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
};

/// Sinters the state and writes a state at each wanted density and time, in the order in which they are reached.
/// Returns false if a step did not converge. Ends early, with the last state written, once a stop is requested.
/// Throws Error for a wanted density or time that lies behind the state.
bool sinter(State state, const Options& options, const Sinks& sinks);

}  // namespace kiln::sinter
