// size_classes.cpp: shares by volume into shares by number, exactly, and diameters out of them.
#include "packing/size_classes.h"

#include <algorithm>
#include <cmath>

#include "core/types.h"

namespace kiln::packing {

namespace {

constexpr double z_of_tenth = 1.2815515655446004;  // standard deviations from the median to D10 and D90 of a normal distribution
constexpr double min_diameter = 1e-15, max_diameter = 1e6;  // m; third powers beyond them, and their sums, may be no numbers
constexpr int steps_between = 32;                  // points of a smooth curve between two percentiles

int power_of(Weighting weighting) { return weighting == Weighting::volume ? 3 : 0; }

/// Mean of d^power over a class in which ln d is spread evenly.
double mean_power(const SizeClass& one, int power) {
    const double width = std::log(one.upper / one.lower);
    const double begin = std::pow(one.lower, power);
    return width == 0.0 || power == 0 ? begin : begin * std::expm1(power * width) / (power * width);
}

/// The diameter below which lies this fraction of a class whose density over ln d goes as d^power.
double inside(const SizeClass& one, int power, double fraction) {
    const double width = std::log(one.upper / one.lower);
    const double way = power == 0 ? fraction * width : std::log1p(fraction * std::expm1(power * width)) / power;
    return std::clamp(one.lower * std::exp(way), one.lower, one.upper);
}

double below(double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); }

}  // namespace

bool is_diameter(double diameter) { return diameter >= min_diameter && diameter <= max_diameter; }

SizeClasses::SizeClasses(const std::vector<SizeClass>& measured, Weighting weighting) : power_(power_of(weighting)) {
    double total = 0.0, before = 0.0;
    for (SizeClass one : measured) {
        if (!(one.lower > 0.0) || !(one.upper >= one.lower) || !(one.lower >= before))
            throw Error("the diameters of a size distribution are positive and ascend");
        if (!is_diameter(one.lower) || !is_diameter(one.upper)) throw Error("a diameter of the size distribution is out of range");
        if (!(one.share >= 0.0)) throw Error("the shares of a size distribution are not negative");
        before = one.upper;
        if (one.share == 0.0) continue;
        one.share *= mean_power(one, -power_);
        total += one.share;
        classes_.push_back(one);
    }
    if (classes_.empty()) throw Error("no class of the size distribution has a share");
    for (SizeClass& one : classes_) one.share /= total;
}

std::vector<double> SizeClasses::draw(std::size_t particles, Random& random) const {
    std::vector<double> diameters;
    std::size_t at = 0;
    double passed = 0.0;  // share of the classes before this one
    for (std::size_t particle = 0; particle < particles; ++particle) {
        const double place = (static_cast<double>(particle) + random.uniform()) / static_cast<double>(particles);
        while (at + 1 < classes_.size() && place >= passed + classes_[at].share) passed += classes_[at++].share;
        const double fraction = std::clamp((place - passed) / classes_[at].share, 0.0, 1.0);
        diameters.push_back(inside(classes_[at], -power_, fraction));
    }
    return diameters;
}

double SizeClasses::quantile(double fraction, Weighting weighting) const {
    // Number goes as d^-power_ inside a class, volume as three powers more.
    const int power = power_of(weighting) - power_;
    std::vector<double> shares;
    double total = 0.0;
    for (const SizeClass& one : classes_) {
        shares.push_back(one.share * mean_power(one, power) / mean_power(one, -power_));
        total += shares.back();
    }
    double passed = 0.0;
    for (std::size_t at = 0; at < classes_.size(); ++at) {
        const double into = (fraction * total - passed) / shares[at];
        if (into <= 1.0 || at + 1 == classes_.size()) return inside(classes_[at], power, std::clamp(into, 0.0, 1.0));
        passed += shares[at];
    }
    throw std::logic_error("a size distribution without classes");
}

double SizeClasses::mean() const {
    double sum = 0.0;
    for (const SizeClass& one : classes_) sum += one.share * mean_power(one, 1 - power_) / mean_power(one, -power_);
    return sum;
}

std::vector<SizeClass> classes_between(const std::vector<Undersize>& points) {
    std::vector<SizeClass> classes;
    const auto add = [&](double lower, double upper, double share) {
        if (share > 0.0) classes.push_back({lower, upper, share});
    };
    add(points.front().diameter, points.front().diameter, points.front().below);
    for (std::size_t point = 1; point < points.size(); ++point)
        add(points[point - 1].diameter, points[point].diameter, points[point].below - points[point - 1].below);
    add(points.back().diameter, points.back().diameter, 1.0 - points.back().below);
    return classes;
}

std::vector<Undersize> through_percentiles(double d10, double d50, double d90, double smallest, double largest) {
    const auto z_of = [&](double diameter) {
        const double unit = diameter < d50 ? std::log(d50 / d10) : std::log(d90 / d50);
        return z_of_tenth * std::log(diameter / d50) / unit;
    };
    const std::vector<Undersize> corners{{smallest, 0.0}, {d10, 0.1}, {d50, 0.5}, {d90, 0.9}, {largest, 1.0}};
    std::vector<Undersize> points{corners.front()};
    for (std::size_t corner = 1; corner < corners.size(); ++corner) {
        const auto [first, first_share] = corners[corner - 1];
        const auto [last, last_share] = corners[corner];
        const double begin = below(z_of(first)), end = below(z_of(last));
        for (int step = 1; step < steps_between; ++step) {
            const double diameter = first * std::pow(last / first, static_cast<double>(step) / steps_between);
            const double part = (below(z_of(diameter)) - begin) / (end - begin);
            points.push_back({diameter, first_share + part * (last_share - first_share)});
        }
        points.push_back(corners[corner]);
    }
    return points;
}

}  // namespace kiln::packing
