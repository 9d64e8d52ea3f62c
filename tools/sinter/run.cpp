// run.cpp: the loop over steps, with its states, history lines and progress.
#include "run.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "cli/tool.h"

namespace kiln::sinter {

namespace {

constexpr double endless = std::numeric_limits<double>::infinity();
constexpr double same_time = 1e-12;          // relative
constexpr double validity_limit = 0.9;       // relative density above which grain growth, which is not modelled, matters

Json summary_of(const numerics::StepRecord& record) {
    return {{"time", record.time},
            {"duration", record.duration},
            {"relative_density", record.relative_density},
            {"strain", {record.strain[0], record.strain[1], record.strain[2]}},
            {"coordination_number", record.contacts.coordination_number},
            {"mean_overlap_ratio", record.contacts.mean_overlap_ratio},
            {"density_error", record.error},
            {"attempts", record.attempts},
            {"newton", record.newton},
            {"conjugate_gradients", record.conjugate_gradients},
            {"converged", record.converged}};
}

/// What is still wanted: ascending densities and times, with the next multiple of --every between.
struct Wanted {
    std::vector<double> densities, times;
    double every, start;

    Wanted(const Options& options, double density, double time)
        : densities(options.densities), times(options.times), every(options.every), start(time) {
        std::sort(densities.begin(), densities.end());
        std::sort(times.begin(), times.end());
        if (!densities.empty() && densities.front() <= density)
            throw Error("the density " + Json(densities.front()).dump() + " is wanted, the state has " + Json(density).dump() + " already");
        if (!times.empty() && times.front() < time)
            throw Error("the time " + Json(times.front()).dump() + " s is wanted, the state is at " + Json(time).dump() + " s already");
    }

    bool done() const { return densities.empty() && times.empty(); }
    double next_density() const { return densities.empty() ? endless : densities.front(); }
    double next_time(double now) const {
        const double listed = times.empty() ? endless : times.front();
        return every > 0.0 ? std::min(listed, start + every * (std::floor((now - start) / every * (1.0 + same_time)) + 1.0)) : listed;
    }

    /// Takes off what has been reached; true if a state is due.
    bool reached(double density, double time, double time_goal) {
        bool due = time >= time_goal * (1.0 - same_time);
        constexpr double same_density = 1e-6;  // relative
        while (!densities.empty() && density >= densities.front() * (1.0 - same_density)) {
            densities.erase(densities.begin());
            due = true;
        }
        while (!times.empty() && time >= times.front() * (1.0 - same_time)) times.erase(times.begin());
        return due;
    }

    /// Part of the way covered, for progress.
    double fraction(const Options& options, double density, double first_density, double time) const {
        if (!options.densities.empty()) {
            const double last = *std::max_element(options.densities.begin(), options.densities.end());
            return (density - first_density) / (last - first_density);
        }
        return (time - start) / (*std::max_element(options.times.begin(), options.times.end()) - start);
    }
};

}  // namespace

bool sinter(State state, const Options& options, const Sinks& sinks) {
    const double first_density = relative_density(state);
    Wanted wanted(options, first_density, state.time);
    numerics::Sintering sintering(std::move(state), options.settings());
    int newton = 0, conjugate_gradients = 0;
    bool converged = true;
    double density = first_density;
    while (!wanted.done()) {
        const double time_goal = wanted.next_time(sintering.time());
        const numerics::StepRecord record = sintering.advance(time_goal, wanted.next_density());
        newton += record.newton;
        conjugate_gradients += record.conjugate_gradients;
        converged = converged && record.converged;
        Json summary = summary_of(record);
        summary["temperature"] = options.temperature;
        if (sinks.history) sinks.history->write(summary);
        sinks.progress.detail(summary);
        if (density <= validity_limit && record.relative_density > validity_limit)
            sinks.warn("above a relative density of 0.9 grains grow, which this model leaves out");
        density = record.relative_density;
        sinks.progress.show(wanted.fraction(options, density, first_density, record.time),
                            "relative density " + Json(std::round(1e4 * density) / 1e4).dump());
        const bool stop = cli::stop_requested();
        if (wanted.reached(density, record.time, time_goal) || stop) {
            summary["steps"] = sintering.steps();
            summary["newton"] = newton;
            summary["conjugate_gradients"] = conjugate_gradients;
            summary["converged"] = converged;
            State reached = sintering.state();
            reached.history.push_back(sinks.entry(summary));
            sinks.states.write(std::move(reached));
        }
        if (stop) break;
    }
    return converged;
}

}  // namespace kiln::sinter
