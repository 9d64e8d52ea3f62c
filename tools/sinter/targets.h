// targets.h: the densities and times that a run still has to write states at.
#pragma once

#include <vector>

#include "options.h"

namespace kiln::sinter {

constexpr double same_density = 1e-6;  // relative; what is nearer counts as reached

/// What is still to be reached: ascending densities and times, with the next multiple of --every between.
class Targets {
   public:
    /// density, time: those of the state at the start of its run. Throws Error for what lies behind them.
    Targets(const Options& options, double density, double time);

    /// True once everything has been reached, or the schedule is over.
    bool done(double time) const;

    double next_density() const;            // infinity if there is none
    double next_time(double now) const;     // s; infinity if there is none
    bool densities_left() const { return !densities_.empty(); }

    /// Takes off what has been reached; true if a state is due. time_goal: the next_time() that the step aimed at.
    bool reached(double density, double time, double time_goal);

    /// Part of the way covered, for progress.
    double fraction(double density, double time) const;

   private:
    std::vector<double> densities_, times_;
    double every_, start_, first_density_, last_density_, last_time_, end_;
};

}  // namespace kiln::sinter
