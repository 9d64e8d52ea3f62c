// select.cpp: the states of a stream nearest to given densities, times or places.
#include <CLI/CLI.hpp>
#include <cmath>
#include <limits>
#include <memory>

#include "tools/common/quantity_options.h"
#include "tools/analyze/analyze.h"
#include "analysis/interpolate.h"
#include "tools/analyze/report.h"
#include "tools/common/each_state.h"
#include "analysis/structure.h"
#include "io/state_io.h"

namespace kiln::analyze {

namespace {

constexpr const char* select_footer =
    "The stream is read once; for every value asked for the nearest state (of equally near ones the first) is written, in the "
    "order asked. With --interpolate it is a state between the first two neighbours in the stream that have the value between "
    "them; they must hold the same particles, by id. Time, box, positions and radii are linear in between; a density is met "
    "exactly in a periodic box.\n\n"
    "Examples:\n"
    "  analyze select --density 0.67,0.79 trajectory.kiln | bondify -o bonded.kiln\n"
    "  sinter --temperature 1200C --every 10s --at-time 1min green.kiln |\n"
    "      analyze select --time 20s -o chosen.kiln\n"
    "  analyze select --interpolate --density 0.7,0.75 trajectory.kiln | bondify | analyze bonds";

constexpr double far_in_density = 0.01;  // above this difference a warning is due

struct SelectOptions {
    std::vector<double> density;
    std::vector<double> time;     // s
    std::vector<double> index;    // from 1
    bool interpolate = false;

    void add_to(CLI::App& app) {
        auto* by_density = cli::add_quantities(app, "--density", density, io::Dimension::none, "Relative densities");
        auto* by_time = cli::add_quantities(app, "--time", time, io::Dimension::time, "Times");
        auto* by_index = cli::add_quantities(app, "--index", index, io::Dimension::none, "Places in the stream, from 1");
        by_density->excludes(by_time)->excludes(by_index);
        by_index->excludes(by_time);
        app.add_flag("--interpolate", interpolate, "Linear between the two states about each value; an index may be 2.5");
        app.callback([this] {
            for (const double place : index) {
                if (!(place > 0.0)) throw CLI::ValidationError("--index", Json(place).dump() + " is not greater than 0");
                if (!interpolate && place != std::floor(place))
                    throw CLI::ValidationError("--index", Json(place).dump() + " is not a whole number");
            }
            if (wanted().empty()) throw CLI::ValidationError("one of --density, --time, --index", "is required");
        });
    }

    std::vector<double> wanted() const {
        if (!density.empty()) return density;
        if (!time.empty()) return time;
        return index;
    }

    const char* key() const { return !density.empty() ? "density" : !time.empty() ? "time" : "index"; }

    /// What the wanted values are compared with; nothing if the state does not have it.
    std::optional<double> value_of(const State& state, std::size_t number) const {
        if (!density.empty()) return analysis::measured_density(state).value;
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

void consider(std::vector<Choice>& choices, const SelectOptions& options, const std::shared_ptr<const State>& candidate,
              std::size_t number) {
    const std::optional<double> value = options.value_of(*candidate, number);
    if (!value) return;
    for (Choice& choice : choices) {
        const double distance = std::abs(*value - choice.wanted);
        if (distance < choice.distance) choice = {choice.wanted, *value, distance, candidate};
    }
}

/// A state of the stream that has a value, and its value.
struct Place {
    double value;
    std::shared_ptr<const State> state;
};

/// The state at a wanted value between two neighbours: linear in time and index, sought by bisection for the density of a periodic
/// box.
State between(const Place& first, const Place& second, double wanted, const SelectOptions& options) {
    double share = (wanted - first.value) / (second.value - first.value);
    if (options.density.empty() || analysis::measured_density(*first.state).measure != "box")
        return analysis::interpolated(*first.state, *second.state, share);
    constexpr int halvings = 40;  // 1e-12 of the way
    double low = 0.0, high = 1.0;
    for (int halving = 0; halving < halvings; ++halving) {
        const double reached = relative_density(analysis::interpolated(*first.state, *second.state, share));
        ((reached < wanted) == (first.value < second.value) ? low : high) = share;
        share = 0.5 * (low + high);
    }
    return analysis::interpolated(*first.state, *second.state, share);
}

void note_crossings(std::vector<Choice>& choices, const SelectOptions& options, const std::optional<Place>& before,
                    const Place& now) {
    for (Choice& choice : choices) {
        const bool at_end = now.value == choice.wanted;
        const bool crossed = before && (before->value - choice.wanted) * (now.value - choice.wanted) < 0.0;
        if (choice.state || !(at_end || crossed)) continue;
        State state = at_end ? *now.state : between(*before, now, choice.wanted, options);
        const double value =
            options.density.empty() ? choice.wanted : analysis::measured_density(state).value.value_or(choice.wanted);
        choice = {choice.wanted, value, 0.0, std::make_shared<const State>(std::move(state))};
    }
}

/// Reads the stream and fills the choices; the number of states read.
std::size_t read(io::Input& input, const SelectOptions& options, std::vector<Choice>& choices) {
    std::size_t states = 0;
    std::optional<Place> before;
    cli::for_each_state(input, [&](State state, const std::string&) {
        if (!options.interpolate) {
            consider(choices, options, std::make_shared<const State>(std::move(state)), ++states);
            return true;
        }
        const std::optional<double> value = options.value_of(state, ++states);
        if (!value) return true;
        const Place now{*value, std::make_shared<const State>(std::move(state))};
        cli::at_place("between it and the state before", [&] { note_crossings(choices, options, before, now); });
        before = now;
        return true;
    });
    return states;
}

/// Refuses what cannot be given and warns of what is far from what was wanted.
void check(const Choice& choice, const SelectOptions& options, std::size_t states, bool quiet) {
    if (!choice.state && options.interpolate)
        throw Error("no two states of the stream have " + std::string(options.key()) + " " + Json(choice.wanted).dump() +
                    " between them");
    if (!choice.state) throw Error("no state of the stream has a measurable density");
    if (!options.index.empty() && choice.distance > 0.0)
        throw Error("there is no state " + std::to_string(static_cast<std::size_t>(choice.wanted)) + ", the stream has " +
                    std::to_string(states));
    if (!options.density.empty() && choice.distance > far_in_density && !quiet)
        cli::warn("analyze select",
                  "the state nearest to density " + Json(choice.wanted).dump() + " has density " + Json(choice.value).dump());
}

}  // namespace

int select(int argc, char** argv) {
    cli::Common common;
    SelectOptions options;
    CLI::App app{"Writes the states of a stream that are nearest to given densities, times or places.", "analyze select"};
    app.footer(select_footer);
    options.add_to(app);
    common.add_to(app);
    cli::parse(app, argc, argv, common);

    io::Input input(common.files, cli::stop_requested);
    io::Output output(common.output, common.text);
    std::vector<Choice> choices;
    for (const double wanted : options.wanted()) choices.push_back({wanted});
    const std::size_t states = read(input, options, choices);
    for (const Choice& choice : choices) check(choice, options, states, common.quiet);
    for (const Choice& choice : choices) {
        State state = *choice.state;
        const Json summary{{"by", options.key()}, {"wanted", choice.wanted}, {"value", choice.value}, {"states", states}};
        io::append_history(state, cli::history_entry("analyze select", app, summary));
        output.write(std::move(state));
    }
    output.commit();
    return cli::done;
}

}  // namespace kiln::analyze
