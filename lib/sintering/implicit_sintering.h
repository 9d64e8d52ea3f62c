// implicit_sintering.h: overdamped sintering in implicit steps, with step control and exact landing on required times and
// densities.
#pragma once

#include <optional>

#include "sintering/candidates.h"
#include "sintering/die.h"
#include "sintering/sintering.h"

namespace kiln::sintering {

class ImplicitSintering : public SinteringMethod {
   public:
    /// Throws Error where the materials lack what the contact law needs, centres coincide, or a pressure has no face to act on.
    ImplicitSintering(State state, const SinteringSettings& settings);

    StepRecord advance(double latest_time, double highest_density) override;

   private:
    Numbers numbers() const override;
    std::vector<NamedArray> arrays() const override;
    void take_up(const Numbers& numbers, const std::vector<NamedArray>& arrays) override;
    /// A trial step and what it led to.
    struct Trial {
        Motion motion, first_order;
        StepReport report;  // of the last solution
        bool converged = true;
        double until = 0.0;        // s
        double log_density = 0.0;  // change over the step
        double difference = 0.0;   // between its two orders
        bool too_far = false;        // further than any list of pairs reaches
        double middle = 0.0;         // s, up to which grains coarsen before the motion
        double rate_change = 0.0;    // by that, of the logarithm of the rate of densification
    };
    /// still: axes along which the box does not strain of itself.
    Eigen::Matrix3d allowed_strain(const Axes& still) const;
    Axes percolating() const { return percolating_axes(body_.size(), candidates_.touching()); }
    /// What a trial step solves, on the pairs chosen last.
    struct Problem {
        const std::vector<double>& diffusion;  // of each pair of materials over the step, m5/N
        const RigidClusters& clusters;
        StepSettings settings;
        Die die;
        std::optional<SinterStep> step;

        void take(const SinteringBody& packing, Candidates& candidates);
    };
    /// True where a span of time is so cold, or the particles so coarse, that no position would change by its last digit.
    bool nothing_moves(double from, double until) const;
    void solve(Problem& problem, bool second, Trial& trial);
    /// The same within the walls of the die.
    void solve_confined(Problem& problem, bool second, Trial& trial);
    Die die_of(const Axes& locked) const;
    /// Takes what the die holds into the settings of the step.
    void hold(Problem& problem) const;
    Trial attempt(double until, const Motion& guess);
    double step_error(const Trial& trial) const;  // estimated, relative, of the density
    double length_factor_for(const Trial& trial) const;    // factor to the length of step that the tolerance allows
    /// A step that the tolerance allows, shorter if a change of the logarithm of the density is expected to come before.
    Trial accepted_attempt(double& duration, double latest_time, double log_change);
    /// True where a trial comes so close to a change of the logarithm of the density that scaling its motion ends there.
    bool near(double log_change, const Trial& trial) const;
    Trial land_on(double log_change, double latest_time, double& duration, const Trial& first);
    /// Of the logarithm of the density, at the start of a step and by time, 1/s and 1/s2 of equivalent time.
    struct Rate {
        double start, slope;
    };
    Rate rate_of(const Trial& trial, double duration) const;
    static double parabola(const Rate& rate, double log_change);  // time in which the change comes; infinity if it never does
    double expected_duration(double log_change) const;            // of the same, by the last two steps
    Motion scaled(const Motion& motion, double factor) const;
    double first_duration();
    StepRecord finish(const Trial& trial, double duration);
    Trial rest(double until);  // a step in which nothing moves
    void coarsen_before(double until, Trial& trial);
    void coarsen_after(const Trial& trial, StepRecord& record);
    void coarsen(double from, double until);
    double affine_rate(double from, double until) const;
    double splitting_error(double log_density, double rate_change) const;  // relative, of the change of density

    Candidates candidates_;
    std::optional<Coarsening> coarsening_;
    Grains start_;                                // of the step under way, while grains coarsen
    Coarsening::Change coarsened_;                // since then; its grains are those of the last half step
    double moved_surface_ = 0.0, moved_boundary_ = 0.0;  // m3, by coarsening since the start of the run
    std::size_t vanished_ = 0;                           // grains
    Motion last_motion_;               // of the last step, the guess of the next one
    double last_rate_ = 0.0, rate_before_ = 0.0;  // of the logarithm of the density in the last two steps, 1/s of equivalent time
    double last_duration_ = 0.0, next_duration_ = 0.0;  // s of equivalent time
    double error_ = 0.0;
    std::size_t idle_steps_ = 0;
    int attempts_ = 0, newton_ = 0, conjugate_gradients_ = 0;  // since the last accepted step
};

}  // namespace kiln::sintering
