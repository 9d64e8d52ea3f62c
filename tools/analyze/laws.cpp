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

/// E/(1 - P) against P is a line for the law with a critical porosity.
std::vector<double> start_pabst(Values porosity, Values modulus) {
    std::vector<double> reduced;
    for (std::size_t point = 0; point < porosity.size(); ++point) reduced.push_back(modulus[point] / (1.0 - porosity[point]));
    const Line line = fit_line(porosity, reduced);
    return {line.intercept, -line.intercept / line.slope};
}

double coble_kingery(double p, Values v) { return v[0] * (1.0 - 1.9 * p + 0.9 * p * p); }
double gibson_ashby(double p, Values v) { return v[0] * (1.0 - p) * (1.0 - p); }

/// A law with the factor E0 alone: the mean of what each point says of it.
template <double (*law)(double, Values)>
std::vector<double> start_factor(Values porosity, Values modulus) {
    const std::vector<double> one{1.0};
    double sum = 0.0;
    for (std::size_t point = 0; point < porosity.size(); ++point) sum += modulus[point] / law(porosity[point], one);
    return {sum / static_cast<double>(porosity.size())};
}

}  // namespace

const std::vector<Law>& laws() {
    static const std::vector<Parameter> factor{{"E0", "Pa"}}, with_b{{"E0", "Pa"}, {"b", ""}},
        with_critical{{"E0", "Pa"}, {"Pc", ""}};
    const auto exponential = [](double p, Values v) { return v[0] * std::exp(-v[1] * p); };
    static const std::vector<Law> table{
        {"knudsen", "E0 exp(-b P)", "F. P. Knudsen, J. Am. Ceram. Soc. 45 (1962) 94", with_b, exponential, start_knudsen},
        {"spriggs", "E0 exp(-b P)", "R. M. Spriggs, J. Am. Ceram. Soc. 44 (1961) 628; knudsen's formula", with_b, exponential,
         start_knudsen, true},
        {"coble-kingery", "E0 (1 - 1.9 P + 0.9 P^2)", "R. L. Coble & W. D. Kingery, J. Am. Ceram. Soc. 39 (1956) 377", factor,
         coble_kingery, start_factor<coble_kingery>},
        {"gibson-ashby", "E0 (1 - P)^2", "L. J. Gibson & M. F. Ashby, Proc. R. Soc. A 382 (1982) 43, open cells", factor,
         gibson_ashby, start_factor<gibson_ashby>},
        {"power", "E0 (1 - P)^b", "K. K. Phani & S. K. Niyogi, J. Mater. Sci. 22 (1987) 257, for pores up to P = 1", with_b,
         [](double p, Values v) { return v[0] * std::pow(1.0 - p, v[1]); }, start_power},
        {"pabst", "E0 (1 - P) (1 - P/Pc)", "W. Pabst & E. Gregorova, J. Mater. Sci. 39 (2004) 3501", with_critical,
         [](double p, Values v) { return v[0] * (1.0 - p) * (1.0 - p / v[1]); }, start_pabst},
        {"linear", "E0 (1 - b P)", "the first term of all others", with_b,
         [](double p, Values v) { return v[0] * (1.0 - v[1] * p); }, start_linear},
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

const std::vector<Reference>& references() {
    static const std::vector<Reference> table{
        {"Knudsen, alumina", "410 GPa exp(-3.95 P)", "F. P. Knudsen, J. Am. Ceram. Soc. 45 (1962) 94; usual values for alumina",
         0.5, [](double p) { return 410e9 * std::exp(-3.95 * p); }},
        {"Coble & Kingery", "400 GPa (1 - 1.9 P + 0.9 P^2)",
         "R. L. Coble & W. D. Kingery, J. Am. Ceram. Soc. 39 (1956) 377; solid of 400 GPa", 0.5,
         [](double p) { return 400e9 * (1.0 - 1.9 * p + 0.9 * p * p); }},
        {"overlapping solid spheres", "400 GPa (1 - P/0.652)^2.23",
         "A. P. Roberts & E. J. Garboczi, J. Am. Ceram. Soc. 83 (2000) 3041; solid of 400 GPa", 0.5,
         [](double p) { return 400e9 * std::pow(1.0 - p / 0.652, 2.23); }},
    };
    return table;
}

}  // namespace kiln::analyze
