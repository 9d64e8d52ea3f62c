// size_distribution.cpp: reading a size distribution from its text and drawing radii from it.
#include "packing/size_distribution.h"

#include <cmath>
#include <fstream>
#include <limits>

#include "core/types.h"
#include "io/quantity.h"

namespace kiln::packing {

namespace {

constexpr double min_share = 1e-3;  // of a lognormal distribution between its cut-offs; drawing from less would take too long

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

Lognormal parse_lognormal(const std::vector<std::string>& parts) {
    Lognormal lognormal{positive_length(parts[1]), io::parse_quantity(parts[2], io::Dimension::none), 0.0,
                        std::numeric_limits<double>::infinity()};
    if (lognormal.deviation < 1.0) throw TextError("the geometric standard deviation is below 1");
    if (parts.size() == 3) return lognormal;
    lognormal.smallest = positive_length(parts[3]);
    lognormal.largest = positive_length(parts[4]);
    const bool sharp = lognormal.deviation == 1.0;
    if (sharp ? lognormal.median < lognormal.smallest || lognormal.median > lognormal.largest
              : share_below(lognormal, lognormal.largest) - share_below(lognormal, lognormal.smallest) < min_share)
        throw TextError("less than a thousandth of the lognormal distribution lies between its cut-offs");
    return lognormal;
}

Bimodal parse_bimodal(const std::vector<std::string>& parts) {
    const Bimodal bimodal{positive_length(parts[1]), positive_length(parts[2]), io::parse_quantity(parts[3], io::Dimension::none)};
    if (bimodal.first_fraction < 0.0 || bimodal.first_fraction > 1.0)
        throw TextError("the number fraction of the first diameter is not between 0 and 1");
    return bimodal;
}

DiameterList read_list(const std::string& name) {
    std::ifstream file(name);
    DiameterList list;
    std::string line;
    for (std::size_t number = 1; std::getline(file, line); ++number) {
        if (!line.empty() && line.back() == '\r') line.pop_back();
        if (line.find_first_not_of(" \t") == std::string::npos) continue;
        try {
            list.diameters.push_back(positive_length(line));
        } catch (const TextError& error) {
            throw Error(name + ", line " + std::to_string(number) + ": " + error.what());
        }
    }
    if (!file.eof()) throw Error(name + ": the list of diameters cannot be read");
    if (list.diameters.empty()) throw Error(name + ": the list of diameters is empty");
    return list;
}

double lognormal_diameter(const Lognormal& lognormal, Random& random) {
    for (;;) {
        const double diameter = lognormal.median * std::pow(lognormal.deviation, random.normal());
        if (diameter >= lognormal.smallest && diameter <= lognormal.largest) return diameter;
    }
}

}  // namespace

SizeDistribution parse_distribution(const std::string& text, double diameter) {
    if (text.starts_with("file:")) return read_list(text.substr(5));
    const std::vector<std::string> parts = split(text);
    if (parts[0] == "monosize" && parts.size() == 1) return Monosize{diameter};
    if (parts[0] == "lognormal" && (parts.size() == 3 || parts.size() == 5)) return parse_lognormal(parts);
    if (parts[0] == "bimodal" && parts.size() == 4) return parse_bimodal(parts);
    throw TextError("'" + text +
                    "' is none of monosize, lognormal:MEDIAN:DEVIATION[:MIN:MAX], bimodal:D1:D2:FRACTION, file:LIST");
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
        for (std::size_t row = 0; row < particles; ++row) radii[row] = 0.5 * list->diameters[row % list->diameters.size()];
    }
    return radii;
}

}  // namespace kiln::packing
