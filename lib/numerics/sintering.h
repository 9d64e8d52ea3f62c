// sintering.h: a packing on its way through sintering: pairs, steps, step control, and landing exactly on wanted times and densities.
#pragma once

#include <limits>
#include <memory>
#include <string>

#include "core/contacts.h"
#include "core/state.h"
#include "numerics/sinter_step.h"

namespace kiln::numerics {

struct SinteringSettings {
    StepSettings step;
    double temperature = 0.0;       // K
    double tolerance = 1e-3;        // relative error of the density over the whole run that the steps aim at
    double density_accuracy = 1e-7; // relative, of a wanted density
};

/// What one step did; also the keys of the density history.
struct StepRecord {
    double time, duration;        // at the end of the step, s; length of the step, s
    double relative_density;      // over a periodic box
    Vec3 strain;                  // logarithmic, since the start
    ContactStatistics contacts;
    double error;                 // estimated, of the density since the start, relative
    int attempts, newton, conjugate_gradients;  // of the step, rejected attempts included
    bool converged;
};

class Sintering {
   public:
    /// Throws Error where the materials lack what the contact law needs, centres coincide, or a particle is not finite.
    Sintering(State state, const SinteringSettings& settings);

    /// One step, ended early at latest_time (s) or where the density reaches highest_density.
    /// Throws Error if nothing densifies any more although a density is wanted.
    StepRecord advance(double latest_time, double highest_density);

    double time() const { return state_.time; }
    double relative_density() const { return density_; }
    std::size_t steps() const { return steps_; }

    /// The present state, particles in the order they came in, positions inside the box.
    State state() const;

   private:
    /// A trial step and what it led to.
    struct Trial {
        Motion motion, first_order;
        StepReport report;
        double log_density = 0.0, first_log_density = 0.0;  // change over the step
        double closing = 0.0;                               // bound of how much any gap closed, m
    };
    double diffusion_over(std::int32_t a, std::int32_t b, double duration) const;
    void find_pairs_with_margin(double closing);
    Eigen::Matrix3d allowed_strain() const;
    double closing_bound(const Motion& motion) const;
    void fill_pair_steps(double duration);
    Trial attempt(double duration, bool tight);
    Trial land_on(double log_change, double& duration, const Trial& beyond);
    double log_density_change(const Motion& motion) const;
    double first_duration();
    void apply(const Trial& trial, double duration);

    State state_;
    std::vector<std::int32_t> order_;  // row in the input of each present row
    SinteringSettings settings_;
    std::vector<double> diffusion_;    // Delta of each pair of materials, m5/(N s)
    std::vector<double> energy_;       // gamma of each pair of materials, J/m2
    std::vector<Pair> pairs_, active_, touching_;  // all within the margin; those that may touch in the step; those that do
    std::vector<PairStep> pair_steps_, active_steps_;
    double margin_left_ = -1.0;        // closing that the list of pairs still covers, m
    std::array<bool, 3> free_axis_{true, true, true};  // may the box strain along this axis
    double largest_radius_ = 0.0, mean_radius_ = 0.0;  // m; the mean is that of volume
    double last_closing_ = 0.0;        // bound of the closing of gaps in the last step, m
    double last_duration_ = 0.0, next_duration_ = 0.0;
    double density_ = 0.0, error_ = 0.0;
    Vec3 strain_ = Vec3::Zero();
    std::size_t steps_ = 0, idle_steps_ = 0;
    int attempts_ = 0, newton_ = 0, conjugate_gradients_ = 0;  // since the last accepted step
};

}  // namespace kiln::numerics
