// law_fit.cpp: weighted nonlinear least squares of a law, by the Levenberg-Marquardt method of Eigen.
#include "analysis/law_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <unsupported/Eigen/LevenbergMarquardt>
#include <unsupported/Eigen/NumericalDiff>

#include "analysis/line_fit.h"
#include "core/types.h"

namespace kiln::analysis {

namespace {

using Eigen::VectorXd;
using physics::PorosityLaw;
using Values = std::span<const double>;

constexpr double tolerance = 1e-13;       // relative, of parameters and of the sum of squares
constexpr double min_spread = 1e-9;     // of the porosities, where more than a factor is sought
constexpr double min_singular = 1e-10;  // smallest over largest singular value below which parameters are not determined

/// First guess: from the line through the points in the law's straight form; of a factor alone the mean of what each point says.
std::vector<double> first_guess(const PorosityLaw& law, Values porosity, Values modulus) {
    std::vector<double> x, y;
    if (law.straight) {
        for (std::size_t point = 0; point < porosity.size(); ++point) {
            x.push_back(law.straight->x(porosity[point]));
            y.push_back(law.straight->y(porosity[point], modulus[point]));
        }
        const Line line = fit_line(x, y);
        return law.straight->parameters(line.intercept, line.slope);
    }
    const std::vector<double> one{1.0};
    double sum = 0.0;
    for (std::size_t point = 0; point < porosity.size(); ++point) sum += modulus[point] / law.modulus(porosity[point], one);
    return {sum / static_cast<double>(porosity.size())};
}

/// Weighted residuals over the largest modulus, as a function of the parameters over their first guesses: numbers near one.
struct Residuals : Eigen::DenseFunctor<double> {
    const PorosityLaw& law;
    Values porosity, modulus, weight;
    std::vector<double> unit;  // of each parameter
    double modulus_unit, weight_unit;

    Residuals(const PorosityLaw& law_, Values porosity_, Values modulus_, Values weight_)
        : DenseFunctor(static_cast<int>(law_.parameters.size()), static_cast<int>(porosity_.size())),
          law(law_),
          porosity(porosity_),
          modulus(modulus_),
          weight(weight_),
          unit(first_guess(law_, porosity_, modulus_)),
          modulus_unit(std::ranges::max(modulus_)),
          weight_unit(std::ranges::max(weight_)) {
        for (double& each : unit)
            if (each == 0.0) each = 1.0;
    }

    std::vector<double> parameters(const VectorXd& scaled) const {
        std::vector<double> values(unit);
        for (std::size_t k = 0; k < values.size(); ++k) values[k] *= scaled[static_cast<Eigen::Index>(k)];
        return values;
    }

    int operator()(const VectorXd& scaled, VectorXd& residuals) const {
        const std::vector<double> values = parameters(scaled);
        for (std::size_t point = 0; point < porosity.size(); ++point)
            residuals[static_cast<Eigen::Index>(point)] = std::sqrt(weight[point] / weight_unit) *
                                                          (modulus[point] - law.modulus(porosity[point], values)) / modulus_unit;
        return 0;
    }
};

using Differentiable = Eigen::NumericalDiff<Residuals, Eigen::Central>;

double weighted_r_squared(Values modulus, Values weight, Values residuals) {
    double weights = 0.0, mean = 0.0, left = 0.0, total = 0.0;
    for (std::size_t point = 0; point < modulus.size(); ++point) {
        weights += weight[point];
        mean += weight[point] * modulus[point];
    }
    mean /= weights;
    for (std::size_t point = 0; point < modulus.size(); ++point) {
        left += weight[point] * residuals[point] * residuals[point];
        total += weight[point] * (modulus[point] - mean) * (modulus[point] - mean);
    }
    return total > 0.0 ? 1.0 - left / total : 1.0;
}

/// Akaike's criterion of a fit and its corrected form.
void add_criteria(Fit& fit, Values weight, std::size_t parameters) {
    double sum = 0.0;
    for (std::size_t point = 0; point < weight.size(); ++point) sum += weight[point] * fit.residuals[point] * fit.residuals[point];
    const auto n = static_cast<double>(weight.size()), k = static_cast<double>(parameters + 1);
    if (fit.degrees_of_freedom > 0) fit.scatter = sum / static_cast<double>(fit.degrees_of_freedom);
    fit.aic = n * std::log(std::max(sum, std::numeric_limits<double>::min()) / n) + 2.0 * k;
    if (n > k + 1.0) fit.aicc = fit.aic + 2.0 * k * (k + 1.0) / (n - k - 1.0);
}

/// s^2 (J^T J)^-1 in the units of the parameters, s^2 the mean square of the weighted residuals.
Eigen::MatrixXd covariance_of(const Eigen::MatrixXd& jacobian, const VectorXd& residuals, std::size_t freedom, Values unit) {
    const Eigen::MatrixXd normal = jacobian.transpose() * jacobian;
    const Eigen::Map<const VectorXd> units(unit.data(), static_cast<Eigen::Index>(unit.size()));
    const double scatter = residuals.squaredNorm() / static_cast<double>(freedom);
    return scatter * (units.asDiagonal() * normal.inverse() * units.asDiagonal());
}

}  // namespace

Fit fit_law(const PorosityLaw& law, Values porosity, Values modulus, Values weight) {
    const std::size_t points = porosity.size(), parameters = law.parameters.size();
    if (points < parameters)
        throw Error("law " + law.name + " has " + std::to_string(parameters) + " parameters, but there are only " +
                    std::to_string(points) + " points");
    Residuals problem(law, porosity, modulus, weight);
    const std::string undetermined =
        "the points do not determine the parameters of law " + law.name + ": their densities are too much alike";
    const auto [least, most] = std::ranges::minmax(porosity);
    const bool has_start = std::ranges::all_of(problem.unit, [](double each) { return std::isfinite(each); });
    if ((parameters > 1 && most - least < min_spread) || !has_start) throw Error(undetermined);

    Differentiable functor(problem);
    Eigen::LevenbergMarquardt<Differentiable> solver(functor);
    solver.setFtol(tolerance);
    solver.setXtol(tolerance);
    VectorXd scaled = VectorXd::Ones(static_cast<Eigen::Index>(parameters));
    const auto status = solver.minimize(scaled);
    if (status == Eigen::LevenbergMarquardtSpace::TooManyFunctionEvaluation || !scaled.allFinite())
        throw Error("the fit of law " + law.name + " did not converge");

    VectorXd residuals(static_cast<Eigen::Index>(points));
    Eigen::MatrixXd jacobian(residuals.size(), scaled.size());
    functor(scaled, residuals);
    functor.df(scaled, jacobian);
    const VectorXd singular = jacobian.jacobiSvd().singularValues();
    if (!(singular.minCoeff() > min_singular * singular.maxCoeff())) throw Error(undetermined);

    Fit fit;
    fit.parameters = problem.parameters(scaled);
    fit.degrees_of_freedom = points - parameters;
    for (std::size_t point = 0; point < points; ++point)
        fit.residuals.push_back(modulus[point] - law.modulus(porosity[point], fit.parameters));
    fit.r_squared = weighted_r_squared(modulus, weight, fit.residuals);
    if (fit.degrees_of_freedom > 0) fit.covariance = covariance_of(jacobian, residuals, fit.degrees_of_freedom, problem.unit);
    add_criteria(fit, weight, parameters);
    return fit;
}

double error_at(const PorosityLaw& law, const Fit& fit, double porosity) {
    VectorXd gradient(static_cast<Eigen::Index>(fit.parameters.size()));
    for (std::size_t k = 0; k < fit.parameters.size(); ++k) {
        const double step =
            1e-5 * (fit.parameters[k] == 0.0 ? 1.0 : std::abs(fit.parameters[k]));  // central differences: 1e-10 is left
        std::vector<double> above(fit.parameters), below(fit.parameters);
        above[k] += step;
        below[k] -= step;
        gradient[static_cast<Eigen::Index>(k)] = (law.modulus(porosity, above) - law.modulus(porosity, below)) / (2.0 * step);
    }
    return std::sqrt(std::max(0.0, gradient.dot(*fit.covariance * gradient)));
}

}  // namespace kiln::analysis
