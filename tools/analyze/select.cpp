// select.cpp: the states of a stream nearest to given densities, times or places.
#include <cmath>
#include <limits>
#include <memory>

#include "cli/units.h"
#include "tools/analyze/analyze.h"
#include "tools/analyze/report.h"
#include "tools/analyze/structure.h"

namespace kiln::analyze {

namespace {

constexpr const char* footer =
    "The stream is read once; for every wanted value the nearest state (of equally near ones the first) is written, in the order "
    "asked.\n"
    "Examples:\n"
    "  analyze select --density 0.67,0.79 history.kiln | bondify\n"
    "  sinter green.kiln --every 10s | analyze select --time 200s -o chosen.kiln";

constexpr double far_in_density = 0.01;  // above this difference a warning is due

struct Options {
    std::vector<double> density;
    std::vector<double> time;        // s
    std::vector<std::size_t> index;  // from 1

    void add_to(CLI::App& app) {
        auto* by_density = app.add_option("--density", density, "relative densities, plain numbers separated by commas");
        auto* by_time = cli::add_quantities(app, "--time", time, cli::Dimension::time, "times, separated by commas");
        auto* by_index = app.add_option("--index", index, "places in the stream, from 1, separated by commas");
        by_density->delimiter(',')->allow_extra_args(false)->excludes(by_time)->excludes(by_index);
        by_index->delimiter(',')->allow_extra_args(false)->check(CLI::PositiveNumber)->excludes(by_time);
        app.callback([this] {
            if (wanted().empty()) throw CLI::ValidationError("one of --density, --time, --index", "is required");
        });
    }

    std::vector<double> wanted() const {
        if (!density.empty()) return density;
        if (!time.empty()) return time;
        return {index.begin(), index.end()};
    }

    const char* key() const { return !density.empty() ? "density" : !time.empty() ? "time" : "index"; }

    /// What the wanted values are compared with; nothing if the state does not have it.
    std::optional<double> value_of(const State& state, std::size_t number) const {
        if (!density.empty()) return measured_density(state).value;
        if (!time.empty()) return state.time;
        return static_cast<double>(number);
    }
};

/// The nearest state so far to one wanted value; wanted values may share a state.
struct Choice {
    double wanted;
    double value = 0.0;
    double distance = std::numeric_limits<double>::infinity();
    std::shared_ptr<const State> state{};
};

void consider(std::vector<Choice>& choices, const Options& options, State&& candidate, std::size_t number) {
    const std::optional<double> value = options.value_of(candidate, number);
    if (!value) return;
    std::shared_ptr<const State> shared;
    for (Choice& choice : choices) {
        const double distance = std::abs(*value - choice.wanted);
        if (!(distance < choice.distance)) continue;
        if (!shared) shared = std::make_shared<const State>(std::move(candidate));
        choice = {choice.wanted, *value, distance, shared};
    }
}

/// Refuses what cannot be given and warns of what is far from what was wanted.
void check(const Choice& choice, const Options& options, std::size_t states, bool quiet) {
    if (!choice.state) throw Error("no state of the stream has a measurable density");
    if (!options.index.empty() && choice.distance > 0.0)
        throw Error("there is no state " + Json(static_cast<std::size_t>(choice.wanted)).dump() + ", the stream has " +
                    std::to_string(states));
    if (!options.density.empty() && choice.distance > far_in_density && !quiet)
        cli::warn("analyze select",
                  "the state nearest to density " + Json(choice.wanted).dump() + " has density " + Json(choice.value).dump());
}

}  // namespace

int select(int argc, char** argv) {
    cli::Common common;
    Options options;
    CLI::App app{"Writes the states of a stream that are nearest to given densities, times or places.", "analyze select"};
    app.footer(footer);
    options.add_to(app);
    common.add_to(app);
    cli::parse(app, argc, argv, common);

    io::Input input(common.files);
    io::Output output(common.output, common.text);
    std::vector<Choice> choices;
    for (const double wanted : options.wanted()) choices.push_back({wanted});
    std::size_t states = 0;
    while (auto state = input.next_state()) consider(choices, options, std::move(*state), ++states);
    for (const Choice& choice : choices) check(choice, options, states, common.quiet);
    for (const Choice& choice : choices) {
        State state = *choice.state;
        const Json summary{{"by", options.key()}, {"wanted", choice.wanted}, {"value", choice.value}, {"states", states}};
        state.history.push_back(cli::history_entry("analyze select", app, summary));
        output.write(std::move(state));
    }
    output.commit();
    return cli::done;
}

}  // namespace kiln::analyze
