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
    std::vector<Parameter> parameters;
    double (*modulus)(double porosity, std::span<const double> parameters);
    std::vector<double> (*start)(std::span<const double> porosity, std::span<const double> modulus);  // first guess
};

/// All laws; to add one is to add an entry.
const std::vector<Law>& laws();

/// Law by name; throws Error that lists the known names.
const Law& law_named(const std::string& name);

struct Fit {
    std::vector<double> parameters;
    std::optional<Eigen::MatrixXd> covariance;  // nothing without degrees of freedom
    std::vector<double> residuals;              // Pa, measured minus law
    double r_squared = 0.0;                     // weighted; 1 for a perfect fit
    std::size_t degrees_of_freedom = 0;
};

/// Weighted nonlinear least squares (Levenberg-Marquardt). weight: one over the square of each point's error, or of any multiple of
/// it: the scatter about the law sets the scale of the covariance.
/// Throws Error for fewer points than parameters, points that do not determine the parameters, or no convergence.
Fit fit_law(const Law& law, std::span<const double> porosity, std::span<const double> modulus, std::span<const double> weight);

}  // namespace kiln::analyze
