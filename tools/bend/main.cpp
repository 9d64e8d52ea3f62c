// main.cpp: bend, three-point bending of bonded bars, state by state.
#include <CLI/CLI.hpp>
#include <optional>

#include "bending/calibration.h"
#include "bending/dynamic_bending.h"
#include "bending/failure.h"
#include "bending/result_document.h"
#include "bending/static_bending.h"
#include "io/files.h"
#include "io/state_io.h"
#include "tools/bend/options.h"
#include "tools/common/material_option.h"
#include "tools/common/progress.h"
#include "tools/common/tool.h"

namespace {

using namespace kiln;

void warn(const std::string& place, const bending::Result& result) {
    if (!result.converged) cli::warn("bend", place + ": some forces stayed unbalanced; see \"residual\" in the result");
    for (const std::string& warning : result.warnings) cli::warn("bend", place + ": " + warning);
}

int run(int argc, char** argv) {
    cli::Common common;
    bend::Options options;
    CLI::App app{"", "bend"};
    options.add_to(app);
    cli::MaterialOption material;
    material.add_to(app);
    common.add_to(app);
    cli::parse(app, argc, argv, common);
    if (common.text && options.states.empty())
        throw CLI::ValidationError("--text", "needs --states; what is written without it is text always");
    cli::check_outputs({common.output, options.states});
    options.solver.begin(common, {&options.states});
    options.linear_solver = options.solver.solver();

    io::Input input(common.files, cli::stop_requested);
    io::Output output(common.output, true);
    std::optional<io::Output> states;
    if (!options.states.empty()) states.emplace(options.states, common.text);
    cli::Progress progress("bend", common);
    bool converged = true;
    const auto test = options.calibrate_to > 0.0                  ? bending::bend_calibrated
                      : options.to_failure()                        ? bending::bend_to_failure
                      : options.method == bending::Method::motion ? bending::bend_dynamic
                                                                  : bending::bend_static;
    material.warn_by([&](const std::string& sentence) {
        if (!common.quiet) cli::warn("bend", sentence);
    });
    std::vector<physics::Use> uses{physics::Use::elasticity};
    if (options.method == bending::Method::motion) uses.push_back(physics::Use::inertia);
    material.needed_for(std::move(uses));
    cli::for_each_state(input, material, [&](State state, const std::string& place) {
        Json history = io::history_of(state);
        const Watch watch{options.solver.stop(), [&](double done) { progress.show(done, place); }};
        const bending::Result result = test(std::move(state), options, watch);
        progress.clear();
        if (!common.quiet) warn(place, result);
        converged = converged && result.converged;
        const Json entry = cli::history_entry("bend", app, bending::summary(result));
        history.push_back(entry);
        output.write(bending::document(result, options, history));
        if (!states) return true;
        State bent = bending::bent_state(result);
        io::append_history(bent, entry);
        states->write(std::move(bent));
        return true;
    });
    output.commit();
    if (states) states->commit();
    return converged ? cli::done : cli::not_converged;
}

}  // namespace

int main(int argc, char** argv) { return kiln::cli::run("bend", argc, argv, run); }
