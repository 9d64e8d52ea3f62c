// size_distribution.cpp: reading a size distribution from its text, drawing radii from it, and what it has below a diameter.
#include "packing/size_distribution.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "analysis/histogram.h"
#include "core/types.h"
#include "io/quantity.h"
#include "packing/size_table.h"

namespace kiln::packing {

namespace {

constexpr double min_share = 1e-3;  // of a lognormal distribution between its cut-offs; drawing from less would take too long
constexpr double rounding = 1e-12;  // of a sum of shares
constexpr int max_halvings = 200;

std::vector<std::string> split(const std::string& text) {
    std::vector<std::string> parts(1);
    for (const char letter : text) {
        if (letter == ':')
            parts.emplace_back();
        else
            parts.back() += letter;
    }
    return parts;
}

double positive_length(const std::string& text) {
    const double length = io::parse_quantity(text, io::Dimension::length);
    if (!(length > 0.0)) throw TextError("the diameter '" + text + "' is not above zero");
    return length;
}

/// Part of a lognormal distribution below a diameter (m).
double share_below(const Lognormal& lognormal, double diameter) {
    return 0.5 * std::erfc(-std::log(diameter / lognormal.median) / (std::sqrt(2.0) * std::log(lognormal.deviation)));
}

/// The median by volume of a lognormal distribution over that by number (Hatch & Choate 1929).
double median_by_volume(double deviation) { return std::exp(3.0 * std::pow(std::log(deviation), 2)); }

Lognormal parse_lognormal(const std::vector<std::string>& parts, Weighting weighting) {
    Lognormal lognormal{positive_length(parts[1]), io::parse_quantity(parts[2], io::Dimension::none), 0.0,
                        std::numeric_limits<double>::infinity()};
    if (lognormal.deviation < 1.0) throw TextError("the geometric standard deviation is below 1");
    if (weighting == Weighting::volume) lognormal.median /= median_by_volume(lognormal.deviation);
    if (!(lognormal.median > 0.0)) throw TextError("the geometric standard deviation is too large");
    if (parts.size() == 3) return lognormal;
    lognormal.smallest = positive_length(parts[3]);
    lognormal.largest = positive_length(parts[4]);
    const bool sharp = lognormal.deviation == 1.0;
    if (sharp ? lognormal.median < lognormal.smallest || lognormal.median > lognormal.largest
              : share_below(lognormal, lognormal.largest) - share_below(lognormal, lognormal.smallest) < min_share)
        throw TextError("less than a thousandth of the lognormal distribution's number lies between its cut-offs");
    return lognormal;
}

Bimodal parse_bimodal(const std::vector<std::string>& parts, Weighting weighting) {
    Bimodal bimodal{positive_length(parts[1]), positive_length(parts[2]), io::parse_quantity(parts[3], io::Dimension::none)};
    if (!(bimodal.first_fraction >= 0.0 && bimodal.first_fraction <= 1.0))
        throw TextError("the fraction of the first diameter is not between 0 and 1");
    if (weighting == Weighting::volume) {
        const double first = bimodal.first_fraction * std::pow(bimodal.second / bimodal.first, 3);
        if (std::isfinite(first)) bimodal.first_fraction = first / (first + 1.0 - bimodal.first_fraction);
    }
    return bimodal;
}

SizeClasses parse_percentiles(const std::vector<std::string>& parts, Weighting weighting) {
    std::vector<double> at;
    for (std::size_t part = 1; part < parts.size(); ++part) at.push_back(positive_length(parts[part]));
    const double d10 = at[0], d50 = at[1], d90 = at[2];
    const double smallest = at.size() == 5 ? at[3] : d10 * d10 / d50, largest = at.size() == 5 ? at[4] : d90 * d90 / d50;
    if (!(smallest < d10 && d10 < d50 && d50 < d90 && d90 < largest))
        throw TextError(
            "percentiles ascend: the smallest diameter is below D10, D10 below D50, D50 below D90, D90 below the largest");
    return {classes_between(through_percentiles(d10, d50, d90, smallest, largest)), weighting};
}

double lognormal_diameter(const Lognormal& lognormal, Random& random) {
    for (;;) {
        const double diameter = lognormal.median * std::pow(lognormal.deviation, random.normal());
        if (diameter >= lognormal.smallest && diameter <= lognormal.largest) return diameter;
    }
}

/// The diameters of a list as often as all of them fit, then others of them, drawn without repetition.
std::vector<double> drawn_from(std::vector<double> list, std::size_t particles, Random& random) {
    std::vector<double> drawn;
    while (particles - drawn.size() >= list.size()) drawn.insert(drawn.end(), list.begin(), list.end());
    for (std::size_t first = 0; drawn.size() < particles; ++first) {  // the first part of a shuffle
        const auto rest = static_cast<double>(list.size() - first);
        std::swap(list[first], list[first + static_cast<std::size_t>(random.uniform() * rest)]);
        drawn.push_back(list[first]);
    }
    return drawn;
}

double quantile_of(const Lognormal& lognormal, double fraction, Weighting weighting) {
    if (lognormal.deviation == 1.0) return lognormal.median;
    Lognormal weighted = lognormal;
    if (weighting == Weighting::volume) weighted.median *= median_by_volume(lognormal.deviation);
    const double begin = share_below(weighted, lognormal.smallest), end = share_below(weighted, lognormal.largest);
    const double far = std::pow(lognormal.deviation, 10.0);
    double low = std::log(std::max(weighted.median / far, lognormal.smallest));
    double high = std::log(std::min(weighted.median * far, lognormal.largest));
    for (int halving = 0; halving < max_halvings && high - low > rounding; ++halving) {
        const double middle = 0.5 * (low + high);
        (share_below(weighted, std::exp(middle)) < begin + fraction * (end - begin) ? low : high) = middle;
    }
    return std::exp(0.5 * (low + high));
}

double quantile_of(const std::vector<double>& diameters, std::vector<double> numbers, double fraction, Weighting weighting) {
    if (weighting == Weighting::volume)
        for (std::size_t row = 0; row < numbers.size(); ++row) numbers[row] *= std::pow(diameters[row], 3);
    return analysis::quantile_of(diameters, numbers, fraction);
}

}  // namespace

SizeDistribution parse_distribution(const std::string& text, double diameter, std::optional<Weighting> weighting,
                                    std::optional<Shares> shares, const FileManner& manner) {
    if (text.starts_with("file:")) return read_sizes(text.substr(5), weighting, shares, manner);
    const std::vector<std::string> parts = split(text);
    const Weighting by = weighting.value_or(parts[0] == "percentiles" ? Weighting::volume : Weighting::number);
    if (parts[0] == "monosize" && parts.size() == 1) return Monosize{diameter};
    if (parts[0] == "lognormal" && (parts.size() == 3 || parts.size() == 5)) return parse_lognormal(parts, by);
    if (parts[0] == "bimodal" && parts.size() == 4) return parse_bimodal(parts, by);
    if (parts[0] == "percentiles" && (parts.size() == 4 || parts.size() == 6)) return parse_percentiles(parts, by);
    throw TextError("'" + text +
                    "' is none of monosize, lognormal:MEDIAN:DEVIATION[:MIN:MAX], bimodal:D1:D2:FRACTION, "
                    "percentiles:D10:D50:D90[:MIN:MAX], file:NAME");
}

std::vector<double> draw_radii(const SizeDistribution& distribution, std::size_t particles, Random& random) {
    std::vector<double> radii(particles);
    if (const auto* monosize = std::get_if<Monosize>(&distribution)) {
        radii.assign(particles, 0.5 * monosize->diameter);
    } else if (const auto* lognormal = std::get_if<Lognormal>(&distribution)) {
        for (double& radius : radii) radius = 0.5 * lognormal_diameter(*lognormal, random);
    } else if (const auto* bimodal = std::get_if<Bimodal>(&distribution)) {
        const auto first = static_cast<std::size_t>(std::llround(bimodal->first_fraction * static_cast<double>(particles)));
        for (std::size_t row = 0; row < particles; ++row) radii[row] = 0.5 * (row < first ? bimodal->first : bimodal->second);
    } else if (const auto* list = std::get_if<DiameterList>(&distribution)) {
        radii = drawn_from(list->diameters, particles, random);
        for (double& radius : radii) radius *= 0.5;
    } else if (const auto* classes = std::get_if<SizeClasses>(&distribution)) {
        radii = classes->draw(particles, random);
        for (double& radius : radii) radius *= 0.5;
    }
    return radii;
}

double size_quantile(const SizeDistribution& distribution, double fraction, Weighting weighting) {
    if (const auto* monosize = std::get_if<Monosize>(&distribution)) return monosize->diameter;
    if (const auto* lognormal = std::get_if<Lognormal>(&distribution)) return quantile_of(*lognormal, fraction, weighting);
    if (const auto* bimodal = std::get_if<Bimodal>(&distribution))
        return quantile_of({bimodal->first, bimodal->second}, {bimodal->first_fraction, 1.0 - bimodal->first_fraction}, fraction,
                           weighting);
    if (const auto* classes = std::get_if<SizeClasses>(&distribution)) return classes->quantile(fraction, weighting);
    const std::vector<double>& diameters = std::get<DiameterList>(distribution).diameters;
    return quantile_of(diameters, std::vector<double>(diameters.size(), 1.0), fraction, weighting);
}

}  // namespace kiln::packing
