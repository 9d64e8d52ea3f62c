// main.cpp: `sinter` sinters packings of particles; `sinter green` makes them.
#include <optional>
#include <string_view>

#include "cli/tool.h"
#include "green.h"
#include "run.h"

namespace {

using namespace kiln;

int sinter_states(int argc, char** argv) {
    CLI::App app("Sinter packings of powder particles: overdamped implicit discrete element method.", "sinter");
    cli::Common common;
    sinter::Options options;
    common.add_to(app);
    options.add_to(app);
    cli::parse(app, argc, argv, common);
    options.check();
    cli::return_freed_memory();

    io::Input input(common.files);
    io::Output states(common.output, common.text);
    std::optional<io::Output> history;
    if (!options.history.empty()) history.emplace(options.history, true);
    cli::Progress progress("sinter", common);
    const auto entry = [&](const Json& summary) { return cli::history_entry("sinter", app, summary); };
    const auto warn = [&](const std::string& sentence) {
        progress.clear();
        if (!common.quiet) cli::warn("sinter", sentence);
    };
    bool converged = true;
    while (auto state = input.next_state()) {
        converged = sinter::sinter(std::move(*state), options, {states, history ? &*history : nullptr, progress, entry, warn}) && converged;
        if (cli::stop_requested()) break;
    }
    progress.clear();
    if (history) history->commit();
    states.commit();
    return converged ? cli::done : cli::not_converged;
}

}  // namespace

int main(int argc, char** argv) {
    return kiln::cli::run("sinter", argc, argv, [](int count, char** words) {
        if (count > 1 && std::string_view(words[1]) == "green") return kiln::sinter::green(count, words);
        return sinter_states(count, words);
    });
}
