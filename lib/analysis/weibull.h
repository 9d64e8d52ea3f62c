// weibull.h: the distribution of strengths of brittle bars, from a few of them.
//
// Probability of fracture at a stress s: 1 - exp(-(s/s0)^m), Weibull modulus m and characteristic strength s0, of which 63.2 % of
// all bars break (W. Weibull, J. Appl. Mech. 18 (1951) 293).
#pragma once

#include <cstddef>
#include <span>

namespace kiln::analysis {

struct Weibull {
    double modulus;                  // m
    double characteristic_strength;  // s0, in the unit of the strengths
};

/// The parameters of the greatest likelihood (ASTM C1239, section 8, without censored strengths). Two strengths or more, all
/// positive. Throws Error where they are all alike, of which no modulus follows.
Weibull fit_weibull(std::span<const double> strengths);

/// How far the parameters found of samples of one size lie from the true ones m, s0: of the fits m', s0' of samples drawn from a
/// distribution both m'/m and m' ln(s0'/s0) have a distribution that depends on neither m nor s0 (D. R. Thoman, L. J. Bain &
/// C. E. Antle, Technometrics 11 (1969) 445), which is that of samples drawn here. ASTM C1239 tabulates the same.
struct WeibullScatter {
    double unbiasing;                      // one over the mean of m'/m: what m' is multiplied by to be right on the average
    double lower_modulus, upper_modulus;   // quantiles of m'/m
    double lower_strength, upper_strength;  // quantiles of m' ln(s0'/s0)
};

/// For samples of so many bars, 3 or more, and quantiles that leave a share `confidence` between them. The same whenever it is
/// called.
WeibullScatter weibull_scatter(std::size_t bars, double confidence);

}  // namespace kiln::analysis
