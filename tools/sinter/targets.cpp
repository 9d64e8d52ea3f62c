// targets.cpp: densities and times, taken off as they are reached.
#include "tools/sinter/targets.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "io/json.h"

namespace kiln::sinter {

namespace {

constexpr double endless = std::numeric_limits<double>::infinity();
constexpr double same_time = 1e-12;    // relative

}  // namespace

Targets::Targets(const Options& options, double density, double time)
    : densities_(options.densities),
      times_(options.times),
      every_(options.every),
      start_(time),
      first_density_(density),
      end_(options.last_time(time)) {
    std::sort(densities_.begin(), densities_.end());
    std::sort(times_.begin(), times_.end());
    if (!densities_.empty() && densities_.front() <= density)
        throw Error("the density " + Json(densities_.front()).dump() + " is asked for, the state has " + Json(density).dump() +
                    " already");
    if (!times_.empty() && times_.front() < time)
        throw Error("the time " + Json(times_.front()).dump() + " s is asked for, the state is at " + Json(time).dump() +
                    " s already");
    if (densities_.empty() && times_.empty()) times_.push_back(end_);
    last_density_ = densities_.empty() ? density : densities_.back();
    last_time_ = times_.empty() ? end_ : times_.back();
}

bool Targets::done(double time) const {
    return (densities_.empty() && times_.empty()) || (times_.empty() && time >= end_ * (1.0 - same_time));
}

double Targets::next_density() const { return densities_.empty() ? endless : densities_.front(); }

double Targets::next_time(double now) const {
    const double listed = times_.empty() ? end_ : times_.front();
    return every_ > 0.0 ? std::min(listed, start_ + every_ * (std::floor((now - start_) / every_ * (1.0 + same_time)) + 1.0))
                        : listed;
}

bool Targets::reached(double density, double time, double time_goal) {
    bool due = time >= time_goal * (1.0 - same_time);
    while (!densities_.empty() && density >= densities_.front() * (1.0 - same_density)) {
        densities_.erase(densities_.begin());
        due = true;
    }
    while (!times_.empty() && time >= times_.front() * (1.0 - same_time)) times_.erase(times_.begin());
    return due;
}

double Targets::fraction(double density, double time) const {
    if (last_density_ > first_density_) return (density - first_density_) / (last_density_ - first_density_);
    return (time - start_) / (last_time_ - start_);
}

}  // namespace kiln::sinter
