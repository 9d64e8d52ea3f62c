// schedule.h: temperature against time, and integrals of functions of temperature along it.
#pragma once

#include <limits>
#include <vector>

namespace kiln::physics {

/// Temperature that changes at a constant rate from corner to corner; before the first and after the last it stays as it is there.
class Schedule {
   public:
    struct Corner {
        double time;         // s
        double temperature;  // K
    };

    /// Corners in the order of time. Throws Error for no corner, times that go back, or a temperature that is not positive.
    explicit Schedule(std::vector<Corner> corners);

    /// One temperature (K) for ever.
    static Schedule hold(double temperature) { return Schedule({{0.0, temperature}}); }

    /// The same, begun at a later time (s).
    Schedule from(double start) const;

    double temperature(double time) const;  // K
    double highest() const;                 // K

    double begin() const { return corners_.front().time; }  // s

    /// Time of the last corner, s; infinity for a hold without end.
    double end() const { return corners_.size() == 1 ? std::numeric_limits<double>::infinity() : corners_.back().time; }

    /// Times between `from` and `until` (s), both included, between which a thermally activated rate changes little enough for
    /// integral() to be exact to rounding: the temperature changes by at most 0.5 % from one to the next.
    std::vector<double> panels(double from, double until) const;

    /// Integral over time of value(temperature in K) from `from` to `until` (s): Gauss-Legendre with eight points a panel.
    template <typename Value>
    double integral(double from, double until, const Value& value) const {
        double sum = 0.0;
        const std::vector<double> ends = panels(from, until);
        for (std::size_t panel = 0; panel + 1 < ends.size(); ++panel) {
            const double middle = 0.5 * (ends[panel] + ends[panel + 1]), half = 0.5 * (ends[panel + 1] - ends[panel]);
            if (constant(ends[panel], ends[panel + 1])) {
                sum += 2.0 * half * value(temperature(middle));
                continue;
            }
            for (std::size_t point = 0; point < 4; ++point)
                for (const double side : {-1.0, 1.0})
                    sum += half * gauss_weight[point] * value(temperature(middle + side * half * gauss_point[point]));
        }
        return sum;
    }

   private:
    /// Points and weights of the rule on [-1, 1], Abramowitz & Stegun 1964, table 25.4.
    static constexpr double gauss_point[4] = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267, 0.9602898564975363};
    static constexpr double gauss_weight[4] = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745, 0.1012285362903763};
    bool constant(double from, double until) const;

    std::vector<Corner> corners_;
};

}  // namespace kiln::physics
