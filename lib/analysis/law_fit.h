// law_fit.h: the weighted least squares fit of a law of modulus against porosity.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "physics/porosity_laws.h"

namespace kiln::analysis {

struct Fit {
    std::vector<double> parameters;
    std::optional<Eigen::MatrixXd> covariance;  // nothing without degrees of freedom
    std::vector<double> residuals;              // Pa, measured minus law
    double r_squared = 0.0;                     // weighted; 1 for a perfect fit
    std::size_t degrees_of_freedom = 0;
    double scatter = 0.0;  // mean square of the weighted residuals, of points of weight one, Pa^2; the variance of such a point
    double aic = 0.0;      // Akaike's criterion, n ln(S/n) + 2 (parameters + 1), S the weighted sum of squares: less is better
    std::optional<double> aicc;  // the same corrected for few points (C. M. Hurvich & C.-L. Tsai, Biometrika 76 (1989) 297)
};

/// Standard error of the law itself at a porosity, Pa, from the covariance of its parameters (which must be there).
double error_at(const physics::PorosityLaw& law, const Fit& fit, double porosity);

/// Weighted nonlinear least squares (Levenberg-Marquardt). weight: one over the square of each point's error, or of any multiple of
/// it: the scatter about the law sets the scale of the covariance.
/// Throws Error for fewer points than parameters, points that do not determine the parameters, or no convergence.
Fit fit_law(const physics::PorosityLaw& law, std::span<const double> porosity, std::span<const double> modulus,
            std::span<const double> weight);

}  // namespace kiln::analysis
