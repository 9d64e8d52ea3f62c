// options.cpp: the command line of `sinter`.
#include "options.h"

#include <algorithm>

#include "cli/units.h"

namespace kiln::sinter {

void Options::add_to(CLI::App& app) {
    using cli::Dimension;
    cli::add_quantities(app, "--to-density", densities, Dimension::none, "Relative densities to write a state at, such as 0.67,0.71");
    cli::add_quantities(app, "--at-time", times, Dimension::time, "Times to write a state at");
    cli::add_quantity(app, "--every", every, Dimension::time, "Also write a state after each such span of time, until the last wanted one");
    cli::add_quantity(app, "--temperature", temperature, Dimension::temperature, "Temperature of the hold")->required();
    app.add_option("--history", history, "File for the density history, one JSON line a step")->type_name("FILE");
    cli::add_quantity(app, "--tolerance", tolerance, Dimension::none, "Relative error of the density over the run to aim at", "1e-3");
    cli::add_quantity(app, "--alpha", constants.alpha, Dimension::none, "Contact constant of the sintering force", "4.5");
    cli::add_quantity(app, "--beta", constants.beta, Dimension::none, "Contact constant of the viscosities", "4");
    cli::add_quantity(app, "--eta", constants.eta, Dimension::none, "Contact constant of tangential friction", "0.01");
    app.footer(
        "Reads states, sinters each, and writes a state at every wanted density or time.\n"
        "`sinter green --help` describes the command that makes green bodies.\n\n"
        "Examples:\n"
        "  sinter green -n 6000 --density 0.43 | sinter --temperature 1200C --to-density 0.67,0.88 -o fired.kiln\n"
        "  sinter --temperature 1200C --at-time 10min,1h --history history.jsonl green.kiln | analyze density --table\n"
        "  sinter --temperature 1473K --to-density 0.79 < green.kiln | bondify | analyze bonds");
}

void Options::check() const {
    if (densities.empty() && times.empty()) throw CLI::ValidationError("one of --to-density and --at-time is wanted");
    for (const double density : densities)
        if (!(density > 0.0 && density < 1.0))
            throw CLI::ValidationError("--to-density: " + Json(density).dump() + " is not between 0 and 1");
    for (const double time : times)
        if (!(time >= 0.0)) throw CLI::ValidationError("--at-time: a time is not negative");
    if (!(every >= 0.0)) throw CLI::ValidationError("--every: a span of time is not negative");
    if (!(tolerance > 0.0 && tolerance < 1.0)) throw CLI::ValidationError("--tolerance is between 0 and 1");
    if (!(constants.alpha >= 0.0 && constants.beta > 0.0 && constants.eta >= 0.0))
        throw CLI::ValidationError("--alpha and --eta are not negative and --beta is positive");
}

numerics::SinteringSettings Options::settings() const {
    numerics::SinteringSettings settings;
    settings.step.constants = constants;
    settings.temperature = temperature;
    settings.tolerance = tolerance;
    settings.step.solver_tolerance = std::min(tolerance, settings.step.solver_tolerance);
    return settings;
}

}  // namespace kiln::sinter
