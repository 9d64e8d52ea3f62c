// porosity_laws.cpp: the laws of modulus against porosity, and curves of the literature.
#include "physics/porosity_laws.h"

#include <cmath>

#include "core/types.h"

namespace kiln::physics {

namespace {

using Values = std::span<const double>;

double exponential(double p, Values v) { return v[0] * std::exp(-v[1] * p); }
double power(double p, Values v) { return v[0] * std::pow(1.0 - p, v[1]); }
double pabst(double p, Values v) { return v[0] * (1.0 - p) * (1.0 - p / v[1]); }
double linear(double p, Values v) { return v[0] * (1.0 - v[1] * p); }
double coble_kingery(double p, Values v) { return v[0] * (1.0 - 1.9 * p + 0.9 * p * p); }
double gibson_ashby(double p, Values v) { return v[0] * (1.0 - p) * (1.0 - p); }

double porosity_itself(double p) { return p; }
double logarithm_of(double, double modulus) { return std::log(modulus); }

/// ln E against P.
constexpr StraightForm exponential_line{
    porosity_itself, logarithm_of, [](double intercept, double slope) { return std::vector{std::exp(intercept), -slope}; }};

/// ln E against ln(1 - P).
constexpr StraightForm power_line{[](double p) { return std::log(1.0 - p); }, logarithm_of,
                                  [](double intercept, double slope) { return std::vector{std::exp(intercept), slope}; }};

/// E/(1 - P) against P.
constexpr StraightForm pabst_line{porosity_itself, [](double p, double modulus) { return modulus / (1.0 - p); },
                                  [](double intercept, double slope) { return std::vector{intercept, -intercept / slope}; }};

constexpr StraightForm linear_line{porosity_itself, [](double, double modulus) { return modulus; },
                                   [](double intercept, double slope) { return std::vector{intercept, -slope / intercept}; }};

}  // namespace

const std::vector<PorosityLaw>& porosity_laws() {
    static const std::vector<Parameter> factor{{"E0", "Pa"}}, with_b{{"E0", "Pa"}, {"b", ""}},
        with_critical{{"E0", "Pa"}, {"Pc", ""}};
    static const std::vector<PorosityLaw> table{
        {"knudsen", "E0 exp(-b P)", "F. P. Knudsen, J. Am. Ceram. Soc. 45 (1962) 94", with_b, exponential, exponential_line},
        {"spriggs", "E0 exp(-b P)", "R. M. Spriggs, J. Am. Ceram. Soc. 44 (1961) 628; knudsen's formula", with_b, exponential,
         exponential_line, true},
        {"coble-kingery", "E0 (1 - 1.9 P + 0.9 P^2)", "R. L. Coble & W. D. Kingery, J. Am. Ceram. Soc. 39 (1956) 377", factor,
         coble_kingery, {}},
        {"gibson-ashby", "E0 (1 - P)^2", "L. J. Gibson & M. F. Ashby, Proc. R. Soc. A 382 (1982) 43, open cells", factor,
         gibson_ashby, {}},
        {"power", "E0 (1 - P)^b", "K. K. Phani & S. K. Niyogi, J. Mater. Sci. 22 (1987) 257, for pores up to P = 1", with_b,
         power, power_line},
        {"pabst", "E0 (1 - P) (1 - P/Pc)", "W. Pabst & E. Gregorova, J. Mater. Sci. 39 (2004) 3501", with_critical, pabst,
         pabst_line},
        {"linear", "E0 (1 - b P)", "the first term of all others", with_b, linear, linear_line},
    };
    return table;
}

const PorosityLaw& porosity_law(const std::string& name) {
    std::string known;
    for (const PorosityLaw& law : porosity_laws()) {
        if (law.name == name) return law;
        known += (known.empty() ? "" : ", ") + law.name;
    }
    throw Error("there is no law '" + name + "', only " + known);
}

const std::vector<ReferenceCurve>& reference_curves() {
    static const std::vector<ReferenceCurve> table{
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

}  // namespace kiln::physics
