// activated_time.cpp: integrals of activated rates between the nodes of a firing, and what lies inside such a span.
#include "analysis/activated_time.h"

#include <algorithm>
#include <cmath>

namespace kiln::analysis {

namespace {

const double gauss_point = 1.0 / std::sqrt(3.0);  // of two on [-1, 1]
constexpr double straight = 1e-9;                 // growth below which a rate counts as constant

/// Part of the integral of exp(growth x) over x from 0 to 1 that lies below x.
double part_below(double x, double growth) {
    return std::abs(growth) < straight ? x : std::expm1(growth * x) / std::expm1(growth);
}

/// Its inverse.
double place_of(double part, double growth) {
    return std::abs(growth) < straight ? part : std::log1p(part * std::expm1(growth)) / growth;
}

}  // namespace

FiringPath::FiringPath(const physics::Schedule& schedule, double from, double until) : time(schedule.panels(from, until)) {
    for (const double each : time) temperature.push_back(schedule.temperature(each));
}

ActivatedTime::ActivatedTime(const FiringPath& path, const std::function<double(double)>& rate) : path_(path), integral_{0.0} {
    double last = rate(path.temperature.front());
    for (std::size_t node = 0; node + 1 < path.time.size(); ++node) {
        const double begin = path.temperature[node], end = path.temperature[node + 1];
        const double middle = 0.5 * (begin + end), half = 0.5 * (end - begin) * gauss_point;
        const double mean = 0.5 * (rate(middle - half) + rate(middle + half)), next = rate(end);
        integral_.push_back(integral_.back() + mean * (path.time[node + 1] - path.time[node]));
        growth_.push_back(std::log(next / last));
        last = next;
    }
}

double ActivatedTime::at(double time) const {
    if (!(time > path_.time.front())) return 0.0;
    if (time >= path_.time.back()) return whole();
    const auto node = static_cast<std::size_t>(std::ranges::upper_bound(path_.time, time) - path_.time.begin()) - 1;
    const double x = (time - path_.time[node]) / (path_.time[node + 1] - path_.time[node]);
    return integral_[node] + part_below(x, growth_[node]) * (integral_[node + 1] - integral_[node]);
}

double ActivatedTime::time_of(double integral) const {
    if (!(integral > 0.0)) return path_.time.front();  // nor does NaN have a time
    if (!(integral < whole())) return path_.time.back();
    const auto node = static_cast<std::size_t>(std::ranges::upper_bound(integral_, integral) - integral_.begin()) - 1;
    const double part = (integral - integral_[node]) / (integral_[node + 1] - integral_[node]);
    return path_.time[node] + place_of(part, growth_[node]) * (path_.time[node + 1] - path_.time[node]);
}

}  // namespace kiln::analysis
