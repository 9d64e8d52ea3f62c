// implicit_sintering.cpp: the loop around the implicit step: candidates, trial steps, step control, landing.
#include "sintering/implicit_sintering.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace kiln::sintering {

namespace {

constexpr double max_approach = 1.0;     // of the mean radius, of any gap in a step
constexpr double max_log_step = 0.05;   // of the density
constexpr double guess_margin = 1.2;        // of the motion that is guessed, that pairs are listed for
constexpr double first_approach = 2e-3;      // of the radius, in the first step, by the pair law
constexpr double third_order_factor = 3.0;  // error of the second-order step over (difference of the orders times log step)
constexpr double accepted_factor = 0.7;       // factor to the length that meets the tolerance, of an accepted step
constexpr double min_factor = 0.2;     // of a rejected step's length
constexpr double typical_log_range = 0.4;   // of a whole run, over which the tolerance is spread
constexpr std::size_t small_packing = 1000; // particles; solving closely costs nothing there
constexpr double small_fraction = 3e-4;        // of the solver's tolerance
constexpr double predictor_fraction = 10.0;  // of the solver's tolerance, for a first-order solution that only prepares the second
constexpr double first_order_fraction = 0.03;  // of it, for first-order steps, whose error falls with their length only slowly
constexpr double harmless_fraction = 0.03;     // of the tolerance, change of density in a first-order step that needs no control
constexpr double invisible_approach = 1e-20;  // of the mean radius; the rounding of a position is 1e-16 and more of it, and no
                                              // force in a packing is thousands of times that of an isolated pair
constexpr double splitting_factor = 0.125;  // Strang's relative error of a step's change of density over the square of the change
                                            // of its rate by coarsening: 1/24 where nothing else changes it
constexpr double harmless_splitting = 1e-3;  // of the tolerance, change of density by that in a step that needs no control
constexpr double same_time = 1e-12;         // relative: the rounding of the time that is left of a schedule
constexpr std::size_t max_idle_steps = 100;
constexpr double idle = 1e-10;              // log density change of an idle step

constexpr int limit_corrections = 4;         // of springs at neck limits, each of which takes off most of what is left
constexpr double landing_closeness = 0.05;  // of a step's change of density, within which its motion is scaled: the error is half
                                            // of the square of that times the change of rate in a step, 1e-4 of the step
constexpr int max_landings = 40;           // attempts to end a step at a required density
constexpr int max_rejections = 20;         // of one step

}  // namespace

ImplicitSintering::ImplicitSintering(State state, const SinteringSettings& settings)
    : SinteringMethod(std::move(state), settings),
      candidates_(body_, kinetics_, settings_.constants, settings_.coarsening.any()) {
    if (settings_.coarsening.any()) coarsening_.emplace(body_.working(), settings_.coarsening);
    next_duration_ = first_duration();
}

double ImplicitSintering::first_duration() {
    const std::vector<double> diffusion = kinetics_.diffusion_at(kinetics_.schedule().highest());
    double shortest = std::numeric_limits<double>::infinity(), overlap = 0.0;
    std::size_t contacts = 0;
    for (const Pair& pair : body_.pairs()) {
        const PairStep step = candidates_.pair_step(pair, diffusion, 1.0);
        if (step.overlap < 0.0) continue;
        overlap += step.overlap / step.reduced_radius;
        ++contacts;
    }
    if (contacts > 0) overlap /= static_cast<double>(contacts);
    for (const Pair& pair : body_.pairs()) {  // time in which a pair of mean overlap closes by first_approach
        const PairStep step = candidates_.pair_step(pair, diffusion, 1.0);
        const double start = overlap * step.reduced_radius, end = start + 2.0 * first_approach * step.reduced_radius;
        if (step.cubic > 0.0)
            shortest = std::min(shortest, step.cubic * physics::viscosity_integral(start, end) / step.force);
    }
    return std::isfinite(shortest) ? shortest : 1.0;
}

Eigen::Matrix3d ImplicitSintering::allowed_strain(const Axes& still) const {
    // Along an axis that no contacts reach through, nothing resists or drives a strain: it follows the mean of the axes that
    // contacts do reach through, so that loose clusters move with the flow of the whole.
    const Axes percolates = percolating();
    std::vector<Vec3> basis;
    Vec3 followers = Vec3::Zero();
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (!body_.box().periodic[axis] || settings_.fixed[axis] || still[axis]) continue;
        const Vec3 along = Vec3::Unit(static_cast<Eigen::Index>(axis));
        if (percolates[axis])
            basis.push_back(along);
        else
            followers += along;
    }
    if (basis.empty()) return Eigen::Matrix3d::Zero();
    Eigen::MatrixXd columns(3, basis.size());
    for (std::size_t k = 0; k < basis.size(); ++k)
        columns.col(static_cast<Eigen::Index>(k)) = basis[k] + followers / static_cast<double>(basis.size());
    return columns * (columns.transpose() * columns).ldlt().solve(columns.transpose());
}

Motion ImplicitSintering::scaled(const Motion& motion, double factor) const {
    Motion guess(body_.size());
    if (motion.displacement.size() != guess.displacement.size()) return guess;
    for_rows(guess.displacement.size(), [&](std::size_t k) { guess.displacement[k] = factor * motion.displacement[k]; });
    guess.strain = factor * motion.strain;
    return guess;
}

void ImplicitSintering::Problem::take(const SinteringBody& packing, Candidates& candidates) {
    candidates.turn_to_nodes(clusters);
    step.emplace(packing.box(), clusters.places(), candidates.pairs(), candidates.steps(), settings);
}

void ImplicitSintering::solve(Problem& problem, bool second, Trial& trial) {
    Motion& motion = second ? trial.motion : trial.first_order;
    for (;;) {  // until no pair that comes to touch was left out; ends, since what is chosen only grows
        Motion nodes = problem.clusters.nodes(motion);
        project(nodes, problem.settings.allowed_strain);
        if (problem.settings.held_strain) nodes.strain += *problem.settings.held_strain;
        trial.report = second ? problem.step->second_order(problem.clusters.nodes(trial.first_order), nodes)
                              : problem.step->first_order(nodes);
        trial.converged = trial.converged && trial.report.converged;
        newton_ += trial.report.newton;
        conjugate_gradients_ += trial.report.conjugate_gradients;
        motion = problem.clusters.particles(nodes);
        trial.too_far = body_.approach_bound(motion) > max_approach * body_.mean_radius();
        if (trial.too_far) return;  // no list of pairs is made for such a leap: the step is too long
        body_.cover(motion);
        if (candidates_.complete(motion)) return;
        candidates_.choose(trial.first_order, trial.motion, problem.diffusion, true);
        problem.take(body_, candidates_);
    }
}

Die ImplicitSintering::die_of(const Axes& locked) const {
    Axes confined = settings_.confined;
    if (confined == Axes{}) return {{}, {}, Vec3::Zero()};
    for (std::size_t axis = 0; axis < 3; ++axis) confined[axis] = confined[axis] && !locked[axis];
    return {confined, percolating(), die_gap(body_.strain())};
}

void ImplicitSintering::hold(Problem& problem) const {
    Axes still = problem.clusters.locked();
    for (std::size_t axis = 0; axis < 3; ++axis) still[axis] = still[axis] || problem.die.held()[axis];
    problem.settings.allowed_strain = allowed_strain(still);
    if (problem.die.held() != Axes{}) problem.settings.held_strain = problem.die.strain();
    else problem.settings.held_strain.reset();
}

void ImplicitSintering::solve_confined(Problem& problem, bool second, Trial& trial) {
    for (;;) {
        solve(problem, second, trial);
        if (trial.too_far || !problem.die.revise((second ? trial.motion : trial.first_order).strain, trial.report.stress)) break;
        hold(problem);
        problem.take(body_, candidates_);
    }
    if (!trial.too_far && problem.die.pulls(trial.report.stress)) trial.converged = false;
}

ImplicitSintering::Trial ImplicitSintering::attempt(double until, const Motion& guess) {
    Trial trial;
    trial.until = until;
    coarsen_before(until, trial);
    body_.cover(guess, guess_margin);
    ++attempts_;
    const std::vector<double> diffusion = kinetics_.diffusion_over(body_.time(), until);
    candidates_.choose(guess, guess, diffusion);
    const RigidClusters clusters(body_.box(), body_.particles().position, candidates_.sticking());
    const double closely = settings_.solver_tolerance * (body_.size() < small_packing ? small_fraction : 1.0);
    const StepSettings settings{.pressure = candidates_.unit() * settings_.pressure,
                                .first_tolerance = closely * (settings_.second_order ? predictor_fraction : first_order_fraction),
                                .second_tolerance = closely,
                                .balance_first = !settings_.second_order,
                                // Coarsening moves the limits themselves by far more than the springs yield.
                                .limit_corrections = coarsening_ ? 0 : limit_corrections,
                                .stop = settings_.stop};
    Problem problem{diffusion, clusters, settings, die_of(clusters.locked()), std::nullopt};
    hold(problem);
    problem.take(body_, candidates_);
    trial.motion = trial.first_order = guess;
    solve_confined(problem, false, trial);
    trial.motion = trial.first_order;
    if (!trial.too_far) solve_confined(problem, true, trial);
    if (trial.too_far) return trial;
    for (std::size_t axis = 0; axis < 3; ++axis)  // without faces there is no stress to speak of
        trial.report.stress[static_cast<Eigen::Index>(axis)] *= body_.box().periodic[axis] ? 1.0 / candidates_.unit() : 0.0;
    trial.log_density = body_.log_density_change(trial.motion);
    trial.difference = std::abs(trial.log_density - body_.log_density_change(trial.first_order));
    if (settings_.second_order) return trial;
    trial.motion = trial.first_order;
    trial.log_density = body_.log_density_change(trial.motion);
    return trial;
}

bool ImplicitSintering::near(double log_change, const Trial& trial) const {
    return std::isfinite(log_change) && std::abs(trial.log_density - log_change) <= landing_closeness * log_change;
}

ImplicitSintering::Trial ImplicitSintering::land_on(double log_change, double latest_time, double& duration,
                                                    const Trial& first) {
    // The density is a smooth function of the step's length: first a parabola through the last step's rate, then secants inside the
    // bracket. What is left in the end is taken by scaling the motion, so that the density is exact.
    double low = 0.0, high = duration;
    double before = 0.0, before_change = 0.0;
    Trial trial = first;
    for (int iteration = 0; iteration < max_landings && !near(log_change, trial); ++iteration) {
        const double miss = trial.log_density - log_change, rate = (trial.log_density - before_change) / (duration - before);
        (miss > 0.0 ? high : low) = duration;
        const double next = iteration == 0 ? parabola(rate_of(trial, duration), log_change) : duration - miss / rate;
        before = std::exchange(duration, next > low && next < high ? next : 0.5 * (low + high));
        before_change = trial.log_density;
        trial = attempt(kinetics_.after(body_.time(), duration), scaled(trial.motion, log_change / trial.log_density));
    }
    const Rate rate = rate_of(trial, duration);
    const double mean = trial.log_density / duration, end = std::clamp(rate.start + rate.slope * duration, 0.5 * mean, 2.0 * mean);
    duration -= (trial.log_density - log_change) / end;
    for (int pass = 0; pass < 3; ++pass) {  // the logarithm of the density is nearly linear in the motion
        trial.motion = scaled(trial.motion, log_change / trial.log_density);
        Die(settings_.confined, {}, die_gap(body_.strain())).confine(trial.motion.strain);
        trial.log_density = body_.log_density_change(trial.motion);
    }
    trial.until = std::min(kinetics_.after(body_.time(), duration), latest_time);
    return trial;
}

ImplicitSintering::Rate ImplicitSintering::rate_of(const Trial& trial, double duration) const {
    // Rates of the last step and this one are those in the middle of each.
    const double rate = trial.log_density / duration;
    const double slope = last_duration_ > 0.0 ? (rate - last_rate_) / (0.5 * (duration + last_duration_)) : 0.0;
    return {rate - 0.5 * duration * slope, slope};
}

double ImplicitSintering::parabola(const Rate& rate, double log_change) {
    const double root = rate.start * rate.start + 2.0 * rate.slope * log_change;
    return root > 0.0 ? 2.0 * log_change / (rate.start + std::sqrt(root)) : std::numeric_limits<double>::infinity();
}

double ImplicitSintering::expected_duration(double log_change) const {
    if (!std::isfinite(log_change) || !(last_rate_ > 0.0) || !(rate_before_ > 0.0)) return std::numeric_limits<double>::infinity();
    const double slope = (last_rate_ - rate_before_) / last_duration_;
    return parabola({last_rate_ + 0.5 * last_duration_ * slope, slope}, log_change);
}

double ImplicitSintering::step_error(const Trial& trial) const {
    return trial.difference * (settings_.second_order ? third_order_factor * std::abs(trial.log_density) : 1.0);
}

double ImplicitSintering::splitting_error(double log_density, double rate_change) const {
    const double error = splitting_factor * rate_change * rate_change;
    return error * std::abs(log_density) > harmless_splitting * settings_.tolerance ? error : 0.0;
}

double ImplicitSintering::length_factor_for(const Trial& trial) const {
    const double splitting = splitting_error(trial.log_density, 2.0 * trial.rate_change);
    if (trial.difference == 0.0 && splitting == 0.0) return std::numeric_limits<double>::infinity();
    const double allowed = settings_.tolerance / typical_log_range;  // of a step, over its change of log density
    if (settings_.second_order && splitting > 0.0) return std::sqrt(allowed / (third_order_factor * trial.difference + splitting));
    const double fraction = allowed / trial.difference;
    if (settings_.second_order) return std::sqrt(fraction / third_order_factor);
    if (splitting > 0.0) return std::min(1.0, std::sqrt(allowed / splitting));
    return fraction * std::max(std::abs(trial.log_density), harmless_fraction * settings_.tolerance);
}

ImplicitSintering::Trial ImplicitSintering::accepted_attempt(double& duration, double latest_time, double log_change) {
    const double left = kinetics_.equivalent(body_.time(), latest_time), lands = expected_duration(log_change);
    duration = std::min({next_duration_, lands, left});
    const bool ends_on_time = duration == left, ends_early = duration < next_duration_;
    double until = ends_on_time ? latest_time : kinetics_.after(body_.time(), duration);
    const double slowing = rate_before_ > 0.0 && last_rate_ > 0.0 ? std::clamp(last_rate_ / rate_before_, 0.5, 1.0) : 1.0;
    Motion guess = scaled(last_motion_, last_duration_ > 0.0 ? slowing * duration / last_duration_ : 0.0);
    Trial trial;
    int rejected = 0;
    for (;; ++rejected) {
        if (!(until > body_.time()))
            throw Error("no step is short enough to converge at " + std::to_string(body_.time()) + " s");
        trial = attempt(until, guess);
        if (!trial.too_far && length_factor_for(trial) >= accepted_factor && std::abs(trial.log_density) <= max_log_step &&
            trial.converged)
            break;
        if (rejected == max_rejections) {
            if (trial.too_far)
                throw Error("particles leap by more than a radius however short the step is at " + std::to_string(body_.time()) +
                            " s");
            break;  // the record says that it did not converge
        }
        const double factor = trial.too_far ? min_factor : std::clamp(0.8 * length_factor_for(trial), min_factor, 0.7);
        guess = trial.too_far ? Motion(body_.size()) : scaled(trial.motion, factor);
        duration *= factor;
        until = kinetics_.after(body_.time(), duration);
    }
    const double growth = std::clamp(0.9 * length_factor_for(trial), 0.5, 2.5);
    next_duration_ = ends_early && rejected == 0 ? std::max(next_duration_, duration * growth) : duration * growth;
    const double log_step_left = 0.8 * max_log_step / std::max(std::abs(trial.log_density), 1e-300);
    next_duration_ = std::min(next_duration_, duration * std::max(log_step_left, 0.5));
    return trial;
}

bool ImplicitSintering::nothing_moves(double from, double until) const {
    if (std::isinf(until)) return false;
    if (until - from <= same_time * until || !(kinetics_.equivalent(from, until) > 0.0)) return true;
    return candidates_.max_isolated_approach(kinetics_.diffusion_over(from, until)) < invisible_approach;
}

StepRecord ImplicitSintering::advance(double latest_time, double highest_density) {
    const double wanted_change = std::log(highest_density / body_.density());
    const double start = body_.time();
    double duration = 0.0;
    Trial trial;
    const double planned_duration = next_duration_;
    if (coarsening_) start_ = body_.grains();
    try {
        if (nothing_moves(start, latest_time)) {
            trial = rest(latest_time);
        } else {
            trial = accepted_attempt(duration, latest_time, wanted_change);
            if (trial.log_density > wanted_change || (trial.until < latest_time && near(wanted_change, trial)))
                trial = land_on(wanted_change, latest_time, duration, trial);
        }
    } catch (...) {
        next_duration_ = planned_duration;  // a run that was stopped on its way to a density resumes as it began
        if (coarsening_) body_.set_grains(start_);  // the state stays as it was before the step
        throw;
    }
    idle_steps_ = std::abs(trial.log_density) < idle ? idle_steps_ + 1 : 0;
    if (idle_steps_ > max_idle_steps && std::isinf(latest_time))
        throw Error("the density stays at " + std::to_string(body_.density()) +
                    "; no contact is left that densifies the box, so " + std::to_string(highest_density) + " cannot be reached");
    StepRecord record = finish(trial, duration);
    record.duration = record.time - start;
    return record;
}

ImplicitSintering::Trial ImplicitSintering::rest(double until) {
    Trial trial;
    trial.until = until;
    trial.motion = trial.first_order = Motion(body_.size());
    coarsen_before(until, trial);
    return trial;
}

/// Rate of densification, up to a constant, of a body whose particles all follow the box.
double ImplicitSintering::affine_rate(double from, double until) const {
    const std::vector<double> diffusion = kinetics_.diffusion_over(from, until);
    double driving = 0.0, viscosity = 0.0;
    for (const Pair& pair : body_.pairs()) {
        const PairStep step = candidates_.pair_step(pair, diffusion, 1.0);
        if (step.overlap < 0.0 || !(step.cubic > 0.0)) continue;
        driving += step.force * step.distance;
        viscosity += step.cubic * physics::viscosity_shape(step.overlap) * step.distance * step.distance;
    }
    return viscosity > 0.0 ? driving / viscosity : 0.0;
}

void ImplicitSintering::coarsen(double from, double until) {
    Coarsening::Change change = coarsening_->over(body_, kinetics_, from, until);
    body_.set_grains(change.grains);
    coarsened_.surface += change.surface;
    coarsened_.boundary += change.boundary;
    coarsened_.substeps += change.substeps;
}

/// The first half of coarsening, of Strang's splitting: from the start of the step to its middle, as sintering counts time.
void ImplicitSintering::coarsen_before(double until, Trial& trial) {
    if (!coarsening_) return;
    body_.set_grains(start_);
    coarsened_ = {};
    const double from = body_.time(), equivalent = kinetics_.equivalent(from, until);
    trial.middle = equivalent > 0.0 ? kinetics_.after(from, 0.5 * equivalent) : 0.5 * (from + until);
    trial.middle = std::clamp(trial.middle, from, until);
    const double before = affine_rate(from, until);
    coarsen(from, trial.middle);
    const double after = affine_rate(from, until);
    trial.rate_change = before > 0.0 && after > 0.0 ? std::log(after / before) : 0.0;
}

/// The second half, after the motion. Grains that have vanished leave the body, and all that has a row a particle.
void ImplicitSintering::coarsen_after(const Trial& trial, StepRecord& record) {
    const double from = body_.time(), before = affine_rate(trial.middle, from);
    coarsen(trial.middle, from);
    const double after = affine_rate(trial.middle, from);
    const double rate_change = trial.rate_change + (before > 0.0 && after > 0.0 ? std::log(after / before) : 0.0);
    error_ += splitting_error(trial.log_density, rate_change) * std::abs(trial.log_density);
    CoarseningRecord& coarsening = record.coarsening.emplace();
    for (std::size_t row = 0; row < body_.size(); ++row)
        if (body_.particles().radius[row] == 0.0) coarsening.vanished.push_back(body_.particles().id[row]);
    std::ranges::sort(coarsening.vanished);
    const std::vector<std::int32_t> rows = body_.remove_vanished();
    if (!coarsening.vanished.empty() && last_motion_.displacement.size() > 3 * rows.size()) {
        for (std::size_t row = 0; row < rows.size(); ++row)
            for (std::size_t axis = 0; axis < 3; ++axis)
                last_motion_.displacement[3 * row + axis] =
                    last_motion_.displacement[3 * static_cast<std::size_t>(rows[row]) + axis];
        last_motion_.displacement.resize(3 * rows.size());
    }
    coarsening.surface = moved_surface_ += coarsened_.surface;
    coarsening.boundary = moved_boundary_ += coarsened_.boundary;
    coarsening.vanished_grains = vanished_ += coarsening.vanished.size();
    coarsening.substeps = coarsened_.substeps;
    std::vector<double> overlap(body_.pairs().size());
    for_rows(overlap.size(), [&](std::size_t row) { overlap[row] = body_.overlap(body_.pairs()[row]); });
    coarsening.size = physics::grain_size(body_.particles().radius, body_.pairs(), overlap);
}

StepRecord ImplicitSintering::finish(const Trial& trial, double duration) {
    body_.apply(trial.motion, trial.until, kinetics_.schedule().temperature(trial.until));
    ++steps_;
    if (duration > 0.0) {
        last_motion_ = trial.motion;
        rate_before_ = std::exchange(last_rate_, trial.log_density / duration);
        last_duration_ = duration;
    }
    error_ += step_error(trial);
    StepRecord record;
    if (coarsening_) coarsen_after(trial, record);
    record.time = body_.time();
    record.temperature = *body_.working().temperature;
    record.relative_density = body_.density();
    record.strain = body_.strain();
    record.stress = trial.report.stress;
    record.contacts = body_.statistics();
    record.error = error_;
    record.attempts = std::exchange(attempts_, 0);
    record.newton = std::exchange(newton_, 0);
    record.conjugate_gradients = std::exchange(conjugate_gradients_, 0);
    record.imbalance = trial.report.imbalance;
    record.converged = trial.converged;
    return record;
}

Numbers ImplicitSintering::numbers() const {
    Numbers numbers{{"last_rate", {last_rate_}},
                    {"rate_before", {rate_before_}},
                    {"last_duration", {last_duration_}},
                    {"next_duration", {next_duration_}},
                    {"density_error", {error_}},
                    {"idle_steps", {static_cast<double>(idle_steps_)}},
                    {"last_strain", triple(last_motion_.strain)}};
    if (coarsening_)
        numbers["coarsening"] = {moved_surface_, moved_boundary_, static_cast<double>(vanished_)};
    return numbers;
}

std::vector<NamedArray> ImplicitSintering::arrays() const {
    return {{"last_motion", {{body_.size(), 3}, scaled(last_motion_, 1.0).displacement}}};
}

void ImplicitSintering::take_up(const Numbers& numbers, const std::vector<NamedArray>& arrays) {
    last_rate_ = number_at(numbers, "last_rate");
    rate_before_ = number_at(numbers, "rate_before");
    last_duration_ = number_at(numbers, "last_duration");
    next_duration_ = number_at(numbers, "next_duration");
    error_ = number_at(numbers, "density_error");
    idle_steps_ = static_cast<int>(number_at(numbers, "idle_steps"));
    last_motion_.strain = triple_at(numbers, "last_strain");
    if (coarsening_) {
        const Vec3 moved = triple_at(numbers, "coarsening");
        moved_surface_ = moved[0];
        moved_boundary_ = moved[1];
        vanished_ = static_cast<std::size_t>(moved[2]);
    }
    last_motion_.displacement = column_of(arrays, "last_motion", body_.size());
}

}  // namespace kiln::sintering
