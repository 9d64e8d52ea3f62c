// schedule.cpp: the corners of a temperature schedule, and the panels between them.
#include "physics/schedule.h"

#include <algorithm>
#include <cmath>

#include "core/types.h"

namespace kiln::physics {

namespace {

constexpr double max_panel = 0.005;  // change of temperature over temperature

}  // namespace

Schedule::Schedule(std::vector<Corner> corners) : corners_(std::move(corners)) {
    if (corners_.empty()) throw Error("the schedule has no temperature");
    for (std::size_t corner = 0; corner < corners_.size(); ++corner) {
        if (!(corners_[corner].temperature > 0.0)) throw Error("a temperature of the schedule is not above 0 K");
        if (corner > 0 && !(corners_[corner].time >= corners_[corner - 1].time)) throw Error("the times of the schedule go back");
    }
}

Schedule Schedule::from(double start) const {
    std::vector<Corner> later = corners_;
    for (Corner& corner : later) corner.time += start;
    return Schedule(std::move(later));
}

double Schedule::temperature(double time) const {
    const auto after = std::ranges::upper_bound(corners_, time, {}, &Corner::time);
    if (after == corners_.begin()) return corners_.front().temperature;
    if (after == corners_.end()) return corners_.back().temperature;
    const Corner& before = *(after - 1);
    return before.temperature + (after->temperature - before.temperature) * (time - before.time) / (after->time - before.time);
}

double Schedule::highest() const {
    return std::max_element(corners_.begin(), corners_.end(), [](const Corner& a, const Corner& b) {
               return a.temperature < b.temperature;
           })->temperature;
}

bool Schedule::constant(double from, double until) const { return temperature(from) == temperature(until); }

std::vector<double> Schedule::panels(double from, double until) const {
    std::vector<double> ends{from};
    const auto reach = [&](double time) {
        const double first = temperature(ends.back()), last = temperature(time);
        const auto count = static_cast<int>(std::ceil(std::abs(std::log(last / first)) / max_panel));
        const double begin = ends.back();
        for (int panel = 1; panel < count; ++panel) ends.push_back(begin + (time - begin) * panel / count);
        ends.push_back(time);
    };
    // A furnace's log has thousands of corners, and most spans lie between two of them.
    for (auto corner = std::ranges::upper_bound(corners_, from, {}, &Corner::time); corner != corners_.end(); ++corner) {
        if (!(corner->time < until)) break;
        reach(corner->time);
    }
    if (until > from) reach(until);
    return ends;
}

}  // namespace kiln::physics
