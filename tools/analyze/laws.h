// laws.h: how Young's modulus falls with porosity, and the weighted least squares fit of such a law.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace kiln::analyze {

struct Parameter {
    std::string name;  // the key of results
    std::string unit;  // "Pa", or "" for a plain number
};

/// A law E(P): porosity P = 1 - relative density, modulus in Pa.
struct Law {
    std::string name;
    std::string formula;  // for help and results
    std::string source;
    std::vector<Parameter> parameters;
    double (*modulus)(double porosity, std::span<const double> parameters);
    std::vector<double> (*start)(std::span<const double> porosity, std::span<const double> modulus);  // first guess
    bool same_as_another = false;  // left out where all laws are compared
};

/// All laws; to add one is to add an entry.
const std::vector<Law>& laws();

/// Law by name; throws Error that lists the known names.
const Law& law_named(const std::string& name);

/// A curve of the literature to compare with; its values are those of its source.
struct Reference {
    std::string name, formula, source;
    double largest_porosity;  // up to which it is meant
    double (*modulus)(double porosity);  // Pa
};

const std::vector<Reference>& references();

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
double error_at(const Law& law, const Fit& fit, double porosity);

/// Weighted nonlinear least squares (Levenberg-Marquardt). weight: one over the square of each point's error, or of any multiple of
/// it: the scatter about the law sets the scale of the covariance.
/// Throws Error for fewer points than parameters, points that do not determine the parameters, or no convergence.
Fit fit_law(const Law& law, std::span<const double> porosity, std::span<const double> modulus, std::span<const double> weight);

}  // namespace kiln::analyze
