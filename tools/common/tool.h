// tool.h: what all four programs share: common options, the one catch, exit statuses, interruption.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "io/json_forward.h"

namespace CLI {
class App;
}

namespace kiln::cli {

inline constexpr const char* version = "0.1.0";

enum Status : int { done = 0, failed = 1, wrong_usage = 2, not_converged = 3, interrupted = 130, closed_pipe = 141 };

/// Adds --help, laid out as in all programs, and --version to the app.
void add_help(CLI::App& app);

/// Options that every tool has. files and output are for tools that read or write streams.
struct Common {
    std::vector<std::string> files;
    std::string output = "-";
    bool text = false;
    bool quiet = false;
    bool verbose = false;
    int threads = 0;  // 0: as many as the machine has

    /// Adds FILE..., -o, --text, -q, -v, --threads, --config, --help, --version to the app, behind what it has already: a
    /// program's own options come first in --help. `reads`: takes input files; `writes_states`: what --text has an effect on.
    void add_to(CLI::App& app, bool reads = true, bool writes_states = true);
};

/// Runs a tool: body adds its options to an app, parses, works and returns its status. This function is the only catch: it turns
/// exceptions into one sentence "tool: …" on stderr and an exit status.
int run(const std::string& tool, int argc, char** argv, const std::function<int(int, char**)>& body);

/// Throws CLI::ValidationError where two outputs of a run have one name: the last one written would replace the other. An empty
/// name is an output that was not asked for; "-" is standard output. Devices and pipes may be named twice.
void check_outputs(const std::vector<std::string>& names);

/// Parses argv; sets the number of threads. Throws CLI::ParseError for run() to report; --help and --version end the tool there.
void parse(CLI::App& app, int argc, char** argv, const Common& common);

/// The history entry of this run: tool, version, the options that bear on the result (those given on the command line or in a
/// config file; not files, threads, output or verbosity), the seed if the tool has one, and a summary of what was done.
Json history_entry(const std::string& tool, const CLI::App& app, const Json& summary);

/// True once SIGINT or SIGTERM has arrived; long loops ask between steps. sinter then writes the
/// state that it reached, the other programs end without output; the status is `interrupted`.
bool stop_requested();

/// One warning sentence on stderr.
void warn(const std::string& tool, const std::string& sentence);

}  // namespace kiln::cli
