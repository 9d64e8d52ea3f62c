// run.cpp: the loop over states and their steps, with written states, history lines, checkpoints and progress.
#include "run.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "tools/common/material_option.h"
#include "tools/common/tool.h"
#include "sintering/explicit_sintering.h"
#include "sintering/implicit_sintering.h"
#include "sintering/viscosity.h"
#include "io/state_io.h"
#include "tools/sinter/targets.h"

namespace kiln::sinter {

namespace {

constexpr double validity_limit = 0.9;  // relative density above which grain growth, which is not modelled, matters
constexpr double closed_pores = 0.92;   // relative density above which the pores of a body are no longer connected
constexpr std::size_t few_grains = 100;  // of which the means of a body do not mean much
constexpr double too_fast = 1e-7;      // s to the densification of visible_densification: sound crosses a grain in 1e-10 s
constexpr double visible_densification = 0.02;
constexpr double full_density = 1.0;    // that no body passes
constexpr double max_contacts = 60.0;  // mean coordination number; a body without pores has about 14
constexpr double max_overlap = 0.5;    // mean, over the sum of the radii; a body without pores has about 0.2

using sintering::triple;


void add_grains(Json& summary, const sintering::CoarseningRecord& coarsening) {
    const physics::GrainSize& size = coarsening.size;
    summary["grains"] = size.grains;
    summary["mean_grain_diameter"] = size.mean_diameter;
    summary["mean_intercept"] = size.mean_intercept;
    summary["diameter_scatter"] = size.scatter;
    summary["neck_coverage"] = size.coverage;
    summary["moved_by_surface"] = coarsening.surface;
    summary["moved_by_boundary"] = coarsening.boundary;
    summary["vanished_grains"] = coarsening.vanished_grains;
    summary["vanished"] = coarsening.vanished;
    summary["substeps"] = coarsening.substeps;
}

Json summary_of(const sintering::StepRecord& record, SinterMethod method) {
    Json summary{{"method", method == SinterMethod::implicit ? "implicit" : "explicit"},
                 {"time", record.time},
                 {"duration", record.duration},
                 {"temperature", record.temperature},
                 {"relative_density", record.relative_density},
                 {"strain", triple(record.strain)},
                 {"engineering_strain", triple(record.strain.unaryExpr([](double axis) { return std::expm1(axis); }))},
                 {"stress", triple(record.stress)},
                 {"coordination_number", record.contacts.coordination_number},
                 {"mean_overlap_ratio", record.contacts.mean_overlap_ratio},
                 {"attempts", record.attempts}};
    if (record.coarsening) add_grains(summary, *record.coarsening);
    if (method == SinterMethod::explicit_steps) return summary;
    summary["density_error"] = record.error;
    summary["newton"] = record.newton;
    summary["conjugate_gradients"] = record.conjugate_gradients;
    summary["imbalance"] = record.imbalance;
    summary["converged"] = record.converged;
    return summary;
}

/// A number as JSON; null where it is not finite.
Json finite(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

/// The viscosities of a state into its summary, and what is to be said of them.
std::vector<std::string> add_viscosities(Json& summary, const State& state, const Options& options) {
    const sintering::ViscousResponse response =
        sintering::viscous_response(state, options.constants, *state.temperature, cli::stop_requested);
    const bool flows = response.flows();
    summary["sintering_stress"] = flows ? Json(response.mean_sintering_stress()) : Json(nullptr);
    summary["bulk_viscosity"] = finite(response.bulk_viscosity());
    summary["shear_viscosity"] = flows ? finite(response.shear_viscosity()) : Json(nullptr);
    for (int row = 0; row < 3; ++row)
        summary["viscosity"].push_back({finite(response.viscosity(row, 0)), finite(response.viscosity(row, 1)),
                                        finite(response.viscosity(row, 2))});
    summary["viscosity_converged"] = response.converged;
    std::vector<std::string> remarks;
    if (!response.converged) remarks.push_back("the viscosities did not converge");
    if (!flows) remarks.push_back("particles that do not diffuse span the box, which does not flow: its viscosity is null");
    const double largest = response.viscosity.diagonal().maxCoeff();
    if (flows && largest > sintering::max_meaningful_viscosity)
        remarks.push_back("at " + Json(*state.temperature).dump() + " K the viscosity is " + Json(largest).dump() +
                          " Pa s: nothing flows that could be measured, ask for it at a temperature of the firing");
    return remarks;
}

std::unique_ptr<sintering::SinteringMethod> method_of(State state, const Options& options) {
    sintering::SinteringSettings settings = options.settings(state.time);
    settings.stop = cli::stop_requested;
    if (options.method == SinterMethod::explicit_steps)
        return std::make_unique<sintering::ExplicitSintering>(std::move(state), settings);
    return std::make_unique<sintering::ImplicitSintering>(std::move(state), settings);
}

/// One state on its way.
class Sintered {
   public:
    Sintered(State state, const std::string& place, const Options& options, const Sinks& sinks, io::RunState run_state)
        : place_(place),
          options_(options),
          sinks_(sinks),
          progressed_(std::move(run_state)),
          targets_(options, kiln::relative_density(state), state.time),
          start_density_(kiln::relative_density(state)),
          start_(state.time),
          method_(method_of(std::move(state), options)) {}

    void take_up(const io::Checkpoint& checkpoint) {
        method_->restore({checkpoint.state, checkpoint.numbers});
        targets_.reached(method_->relative_density(), method_->time(), HUGE_VAL);
    }

    /// What is to be known before the first step.
    void warn_of_start() const {
        for (const sintering::Kinetics::SlowPair& pair : method_->kinetics().taken_as_rigid())
            warn("contacts of " + pair.first + " and " + pair.second + " diffuse " + Json(pair.fraction).dump() +
                        " times as fast as the fastest and count as rigid, as all below " +
                        Json(sintering::Kinetics::rigid_fraction).dump() + " do");
        if (method_->packing().statistics().coordination_number == 0.0)
            warn("no particles touch: nothing sinters until they do");
    }

    /// Steps to the end; false if a stop was requested on the way: the step that it interrupts is not taken.
    bool run() {
        while (!targets_.done(method_->time()) && !full()) {
            try {
                step();
            } catch (const Interrupted&) {
                if (!sinks_.checkpoint.requested()) write_state(last_summary_, false);
            }
            if (cli::stop_requested()) {
                if (sinks_.checkpoint.requested()) write_checkpoint(false);
                return false;
            }
            if (sinks_.checkpoint.due()) write_checkpoint(false);
        }
        if (full()) {
            progressed_.converged = false;
            warn("the body is fully dense at " + Json(method_->time()).dump() +
                        " s, which ends the run: this model has no pores that close");
        } else if (targets_.densities_left()) {
            progressed_.converged = false;
            warn("the schedule ends at a relative density of " + Json(method_->relative_density()).dump() +
                        ", short of the required " + Json(targets_.next_density()).dump());
        }
        return true;
    }

    const io::RunState& run_state() const { return progressed_; }

    void write_checkpoint(bool finished) {
        progressed_.finished = finished;
        progressed_.output_bytes = sinks_.states.flushed_bytes();
        if (sinks_.history) progressed_.history_bytes = sinks_.history->flushed_bytes();
        sintering::Checkpoint reached = method_->checkpoint();
        sinks_.checkpoint.write({std::move(reached.state), std::move(reached.numbers), progressed_});
    }

   private:
    void warn(const std::string& sentence) const { sinks_.warn(place_ + ": " + sentence); }

    bool full() const { return method_->relative_density() >= full_density * (1.0 - same_density); }

    void step() {
        const double density = method_->relative_density(), time_goal = targets_.next_time(method_->time());
        const sintering::StepRecord record = method_->advance(time_goal, std::min(targets_.next_density(), full_density));
        progressed_.newton += record.newton;
        progressed_.conjugate_gradients += record.conjugate_gradients;
        progressed_.converged = progressed_.converged && record.converged;
        if (record.contacts.coordination_number > max_contacts || record.contacts.mean_overlap_ratio > max_overlap)
            throw Error("at " + Json(record.time).dump() + " s particles have " + Json(record.contacts.coordination_number).dump() +
                        " contacts and overlap by " + Json(record.contacts.mean_overlap_ratio).dump() +
                        " of their radii in the mean: the packing has shrunk into itself in a box that stays empty");
        const Json summary = last_summary_ = summary_of(record, options_.method);
        if (sinks_.history) sinks_.history->write(summary);
        sinks_.progress.detail(summary);
        warn_of_limits(density, record);
        warn_of_haste(record);
        sinks_.progress.show(targets_.fraction(record.relative_density, record.time),
                             "relative density " + Json(std::round(1e4 * record.relative_density) / 1e4).dump());
        // A signal that comes after the last look at it: this step's state is the last.
        const bool last_of_all = cli::stop_requested() && !sinks_.checkpoint.requested();
        if (targets_.reached(record.relative_density, record.time, time_goal) || last_of_all || full()) write_state(summary);
    }

    /// Once: times that no powder needs, which come of a wrong constant.
    void warn_of_haste(const sintering::StepRecord& record) {
        if (hasty_ || !(record.relative_density > start_density_ + visible_densification)) return;
        hasty_ = true;
        const double since = record.time - start_;
        if (since < too_fast)
            warn("at " + Json(record.temperature).dump() + " K the relative density is " +
                 Json(std::round(1e4 * record.relative_density) / 1e4).dump() + " after " + Json(since).dump() +
                 " s: no powder sinters so fast, see the units of the material's constants");
    }

    /// What the model leaves out from here on.
    void warn_of_limits(double density, const sintering::StepRecord& record) {
        const auto passes = [&](double limit) { return density <= limit && record.relative_density > limit; };
        if (!options_.coarsening.exchanges()) {
            if (passes(validity_limit)) warn("above a relative density of 0.9 grains grow, which this model leaves out");
            return;
        }
        if (passes(closed_pores))
            warn("above a relative density of about 0.92 pores are closed; what their gas and their own coarsening do is left out");
        if (!few_ && record.coarsening->size.grains < few_grains)
            warn("at " + Json(record.time).dump() + " s fewer than " + std::to_string(few_grains) +
                 " grains are left: means over them scatter, a larger packing is needed");
        few_ = few_ || record.coarsening->size.grains < few_grains;
    }

    /// reported: with what --report asks for.
    void write_state(Json summary, bool reported = true) {
        State reached = method_->state();
        summary["steps"] = method_->steps();
        summary.erase("vanished");  // those of the last step; --history has them all
        summary.erase("substeps");
        if (options_.method == SinterMethod::implicit) {
            summary["newton"] = progressed_.newton;
            summary["conjugate_gradients"] = progressed_.conjugate_gradients;
            summary["converged"] = progressed_.converged;
        }
        if (reported && options_.report == Report::viscosity) {
            for (const std::string& remark : add_viscosities(summary, reached, options_)) warn(remark);
            progressed_.converged = progressed_.converged && summary["viscosity_converged"].get<bool>();
        }
        io::append_history(reached, sinks_.entry(summary));
        sinks_.states.write(std::move(reached));
    }

    std::string place_;  // file and document, for warnings
    const Options& options_;
    const Sinks& sinks_;
    io::RunState progressed_;
    Targets targets_;
    double start_density_, start_;  // of the run; s
    bool hasty_ = false;  // the first densification has been looked at
    bool few_ = false;  // grains are left
    Json last_summary_ = Json::object();
    std::unique_ptr<sintering::SinteringMethod> method_;
};

}  // namespace

int run(io::Input& input, const cli::MaterialOption& material, const Options& options, const Sinks& sinks,
        const std::optional<io::Checkpoint>& earlier) {
    bool converged = !earlier || earlier->run.converged;
    std::size_t document = 0;
    std::unique_ptr<Sintered> last;
    bool interrupted = false;
    cli::for_each_state(input, material, [&](State state, const std::string& place) {
        const std::size_t number = document++;
        if (earlier && number < earlier->run.document) return true;
        const bool taken_up = earlier && number == earlier->run.document;
        io::RunState run_state =
            taken_up ? earlier->run : io::RunState{.document = number, .fingerprint = "", .converged = converged};
        if (sinks.checkpoint.requested()) run_state.fingerprint = io::fingerprint(state);
        if (taken_up) earlier->require_input(run_state.fingerprint);
        last = std::make_unique<Sintered>(std::move(state), place, options, sinks, run_state);
        if (taken_up) last->take_up(*earlier);
        last->warn_of_start();
        const bool whole = last->run();
        converged = last->run_state().converged;
        interrupted = !whole && sinks.checkpoint.requested();
        return whole && (sinks.checkpoint.requested() || !cli::stop_requested());
    });
    if (interrupted) {
        sinks.progress.clear();
        sinks.warn("interrupted; --resume resumes from the checkpoint");
        return cli::interrupted;
    }
    sinks.progress.clear();
    if (last && sinks.checkpoint.requested()) last->write_checkpoint(true);
    if (sinks.history) sinks.history->commit();
    sinks.states.commit();
    sinks.checkpoint.remove();
    return converged ? cli::done : cli::not_converged;
}

int finish(const std::string& output, const std::string& history, const io::RunState& run_state,
           const io::CheckpointFile& checkpoint) {
    if (!history.empty()) io::finish_partial(history);
    io::finish_partial(output);
    checkpoint.remove();
    return run_state.converged ? cli::done : cli::not_converged;
}

}  // namespace kiln::sinter
