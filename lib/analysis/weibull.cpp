// weibull.cpp: Weibull's parameters by maximum likelihood, and the scatter of that.
#include "analysis/weibull.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <random>
#include <vector>

#include "core/types.h"

namespace kiln::analysis {

namespace {

constexpr double tolerance = 1e-12;  // of the modulus
constexpr int max_steps = 200;
constexpr double min_spread = 1e-9;  // of the logarithms of strengths, below which they are alike
constexpr std::size_t drawn_bars = 1'000'000;   // in all samples, about what a tenth of a second allows
constexpr std::size_t min_samples = 4000;
constexpr std::size_t max_samples = 40000;

/// The equation of the modulus, sum x^m ln x / sum x^m - 1/m - mean ln x = 0, and its slope; x relative to the largest strength.
struct Likelihood {
    double value, slope;
};

Likelihood likelihood(std::span<const double> logarithms, double mean, double modulus) {
    double sum = 0.0, first = 0.0, second = 0.0;
    for (const double logarithm : logarithms) {
        const double power = std::exp(modulus * logarithm);
        sum += power;
        first += power * logarithm;
        second += power * logarithm * logarithm;
    }
    first /= sum;
    second /= sum;
    return {first - 1.0 / modulus - mean, second - first * first + 1.0 / (modulus * modulus)};
}

/// Fits logarithms of strengths, the largest of which is 0. They are not all alike.
Weibull fit_logarithms(std::span<const double> logarithms) {
    const auto count = static_cast<double>(logarithms.size());
    const double mean = std::accumulate(logarithms.begin(), logarithms.end(), 0.0) / count;
    double squares = 0.0;
    for (const double logarithm : logarithms) squares += (logarithm - mean) * (logarithm - mean);
    // The equation rises with the modulus from -infinity to -mean > 0, so it has one root. Newton's steps from the value of moments
    // (pi/sqrt(6) over the standard deviation of the logarithms) are kept in the bracket.
    double modulus = 1.2825498301618641 / std::sqrt(squares / count), lower = 0.0, upper = HUGE_VAL;
    for (int step = 0; step < max_steps; ++step) {
        const auto [value, slope] = likelihood(logarithms, mean, modulus);
        (value < 0.0 ? lower : upper) = modulus;
        double next = modulus - value / slope;
        if (!(next > lower && next < upper)) next = std::isinf(upper) ? 2.0 * modulus : 0.5 * (lower + upper);
        const double change = std::abs(next - modulus);
        modulus = next;
        if (change <= tolerance * modulus) break;
    }
    double powers = 0.0;
    for (const double logarithm : logarithms) powers += std::exp(modulus * logarithm);
    return {modulus, std::pow(powers / count, 1.0 / modulus)};
}

/// The logarithms less the largest of them, which comes back.
double take_largest(std::vector<double>& logarithms) {
    const double largest = std::ranges::max(logarithms);
    for (double& logarithm : logarithms) logarithm -= largest;
    return largest;
}

/// The value below which a share of sorted values lies, between the neighbours.
double quantile(const std::vector<double>& sorted, double share) {
    const double place = share * static_cast<double>(sorted.size() - 1);
    const auto below = static_cast<std::size_t>(place);
    const double fraction = place - static_cast<double>(below);
    return below + 1 < sorted.size() ? sorted[below] + fraction * (sorted[below + 1] - sorted[below]) : sorted.back();
}

}  // namespace

Weibull fit_weibull(std::span<const double> strengths) {
    std::vector<double> logarithms;
    for (const double strength : strengths) logarithms.push_back(std::log(strength));
    const double largest = take_largest(logarithms);
    if (-std::ranges::min(logarithms) < min_spread) throw Error("all strengths are alike, so no Weibull modulus follows");
    Weibull found = fit_logarithms(logarithms);
    found.characteristic_strength *= std::exp(largest);
    return found;
}

WeibullScatter weibull_scatter(std::size_t bars, double confidence) {
    std::mt19937_64 random(bars);
    const std::size_t samples = std::clamp(drawn_bars / bars, min_samples, max_samples);
    std::vector<double> modulus(samples), strength(samples), logarithms(bars);
    for (std::size_t sample = 0; sample < samples; ++sample) {
        for (double& logarithm : logarithms) {
            const double uniform = (static_cast<double>(random() >> 11) + 0.5) * 0x1p-53;  // between 0 and 1, neither included
            logarithm = std::log(-std::log(uniform));                                    // of a strength where m = s0 = 1
        }
        const double largest = take_largest(logarithms);
        const Weibull found = fit_logarithms(logarithms);
        modulus[sample] = found.modulus;
        strength[sample] = found.modulus * (std::log(found.characteristic_strength) + largest);
    }
    std::ranges::sort(modulus);
    std::ranges::sort(strength);
    const double below = 0.5 * (1.0 - confidence);
    return {static_cast<double>(samples) / std::accumulate(modulus.begin(), modulus.end(), 0.0), quantile(modulus, below),
            quantile(modulus, 1.0 - below), quantile(strength, below), quantile(strength, 1.0 - below)};
}

}  // namespace kiln::analysis
