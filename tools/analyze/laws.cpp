// laws.cpp: the laws of modulus against porosity, with first guesses from straight lines.
#include "tools/analyze/laws.h"

#include <cmath>

#include "core/types.h"
#include "tools/analyze/line_fit.h"

namespace kiln::analyze {

namespace {

using Values = std::span<const double>;

std::vector<double> logarithms(Values values) {
    std::vector<double> result;
    for (const double value : values) result.push_back(std::log(value));
    return result;
}

/// ln E against P is a line for Knudsen's law.
std::vector<double> start_knudsen(Values porosity, Values modulus) {
    const Line line = fit_line(porosity, logarithms(modulus));
    return {std::exp(line.intercept), -line.slope};
}

std::vector<double> start_linear(Values porosity, Values modulus) {
    const Line line = fit_line(porosity, modulus);
    return {line.intercept, -line.slope / line.intercept};
}

/// ln E against ln(1 - P) is a line for the power law.
std::vector<double> start_power(Values porosity, Values modulus) {
    std::vector<double> density;
    for (const double p : porosity) density.push_back(1.0 - p);
    const Line line = fit_line(logarithms(density), logarithms(modulus));
    return {std::exp(line.intercept), line.slope};
}

}  // namespace

const std::vector<Law>& laws() {
    static const std::vector<Parameter> modulus_and_b{{"E0", "Pa"}, {"b", ""}};
    static const std::vector<Law> table{
        // F. P. Knudsen, J. Am. Ceram. Soc. 42 (1959) 376; for alumina 45 (1962) 94.
        {"knudsen", "E0 exp(-b P)", modulus_and_b, [](double p, Values v) { return v[0] * std::exp(-v[1] * p); }, start_knudsen},
        {"linear", "E0 (1 - b P)", modulus_and_b, [](double p, Values v) { return v[0] * (1.0 - v[1] * p); }, start_linear},
        {"power", "E0 (1 - P)^b", modulus_and_b, [](double p, Values v) { return v[0] * std::pow(1.0 - p, v[1]); }, start_power},
    };
    return table;
}

const Law& law_named(const std::string& name) {
    std::string known;
    for (const Law& law : laws()) {
        if (law.name == name) return law;
        known += (known.empty() ? "" : ", ") + law.name;
    }
    throw Error("there is no law '" + name + "', only " + known);
}

}  // namespace kiln::analyze
