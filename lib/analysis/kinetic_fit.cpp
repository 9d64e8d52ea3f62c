// kinetic_fit.cpp: Levenberg-Marquardt for the constants of diffusion, along a profile of the surface diffusivity.
#include "analysis/kinetic_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <unsupported/Eigen/LevenbergMarquardt>
#include <unsupported/Eigen/NumericalDiff>

#include "analysis/student.h"
#include "core/types.h"
#include "physics/diffusion.h"
#include "physics/materials.h"

namespace kiln::analysis {

using Eigen::VectorXd;
using physics::boltzmann_constant, physics::gas_constant;

namespace {

constexpr double energy_unit = 100e3;    // J/mol: parameters of the search are numbers near one
constexpr double tolerance = 1e-8;       // of parameters and sum of squares
constexpr std::size_t profile_points = 13;
constexpr double beyond_runs = 3.0;      // factor by which the ratio of D_s' to Delta may leave that of the runs
constexpr double min_start = 100e3, max_start = 1000e3, start_step = 100e3;  // J/mol, from where the search may begin
constexpr int halvings = 25;
constexpr double confidence = 0.95;
constexpr double same_time = 1e-9;
constexpr double full_density = 0.9999;

double atomic_volume(const Material& material) { return physics::required(material.atomic_volume, material, "atomic_volume"); }

/// Omega/(k_B T) exp(-Q/(R T)): what a prefactor is multiplied by.
double activation(const Material& material, double energy, double temperature) {
    return physics::diffusion_parameter(atomic_volume(material), 1.0, energy, temperature);
}

}  // namespace

FiringPrediction::FiringPrediction(const DensificationModel& model, const Material& material, const physics::Schedule& schedule,
                                   std::vector<double> times)
    : model_(model),
      material_(material),
      path_(schedule, schedule.begin(), times.back()),
      times_(std::move(times)),
      correction_(times_.size(), 0.0) {}

template <typename Boundary, typename Surface>
FiringPrediction::Prediction FiringPrediction::uncorrected(const Boundary& boundary, const Surface& surface) const {
    const ActivatedTime theta(path_, boundary);
    std::optional<ActivatedTime> sigma;
    if (model_.coarsens()) sigma.emplace(path_, surface);
    Prediction prediction{{}, model_.course(theta, sigma ? &*sigma : nullptr), false};
    for (const double time : times_) prediction.densities.push_back(prediction.course.density(theta.at(time)));
    prediction.beyond = model_.end_density() < full_density && prediction.course.beyond(theta.at(times_.back()));
    return prediction;
}

void FiringPrediction::correct_by(const SimulatedRun& run) {
    const Prediction modelled =
        uncorrected([&](double temperature) { return boundary_rate(run.material, temperature); },
                    [&](double temperature) { return surface_rate(run.material, *run.surface, temperature); });
    const MonotoneCurve simulated(run.time, run.density);
    for (std::size_t row = 0; row < times_.size(); ++row) correction_[row] = simulated.at(times_[row]) - modelled.densities[row];
}

FiringPrediction::Prediction FiringPrediction::predict(const KineticConstants& constants) const {
    const double energy = physics::required(material_.surface_energy, material_, "surface_energy");
    const auto rate = [&](const Activated& of, double temperature) {
        return energy * of.prefactor * activation(material_, of.activation_energy, temperature);
    };
    Prediction prediction = uncorrected([&](double temperature) { return rate(constants.boundary, temperature); },
                                        [&](double temperature) { return rate(*constants.surface, temperature); });
    for (std::size_t row = 0; row < times_.size(); ++row) prediction.densities[row] += correction_[row];
    return prediction;
}

bool follows(const SimulatedRun& run, const physics::Schedule& schedule, const std::vector<double>& times, double tolerance) {
    const bool full = run.density.back() >= full_density;  // and stays so after its end
    return std::ranges::all_of(times, [&](double time) {
        return (full || time <= run.time.back() * (1.0 + same_time)) &&
               std::abs(run.schedule.temperature(time) - schedule.temperature(time)) <= tolerance;
    });
}

double reference_temperature(const std::vector<DensityCurve>& curves) {
    double sum = 0.0, points = 0.0;
    for (const DensityCurve& curve : curves)
        for (const double time : curve.time) {
            double highest = 0.0;
            for (const double node : curve.schedule.panels(curve.schedule.begin(), time))
                highest = std::max(highest, curve.schedule.temperature(node));
            sum += highest;
            points += 1.0;
        }
    return sum / points;
}

namespace {

/// The fit in the variables of the search: ln Delta at the reference temperature, the activation energy over energy_unit, and the
/// logarithm of D_s' over Delta there.
class Search {
   public:
    Search(const DensificationModel& model, const KineticProblem& problem)
        : problem_(problem), temperature_(analysis::reference_temperature(problem.curves)), coarsens_(model.coarsens()) {
        for (std::size_t curve = 0; curve < problem.curves.size(); ++curve) {
            const DensityCurve& measured = problem.curves[curve];
            firings_.emplace_back(model, problem.material, measured.schedule, measured.time);
            if (problem.runs[curve] != nullptr) firings_.back().correct_by(*problem.runs[curve]);
            points_ += measured.size();
        }
        points_ += problem.grains.size();
    }

    std::size_t points() const { return points_; }
    double reference_temperature() const { return temperature_; }

    KineticConstants constants(const VectorXd& x) const {
        const double energy = energy_unit * x[1];
        KineticConstants found{{std::exp(x[0]) / activation(problem_.material, energy, temperature_), energy}, std::nullopt};
        if (coarsens_) {
            const double surface_energy = problem_.surface->activation_energy;
            found.surface =
                Activated{std::exp(x[0] + x[2]) / activation(problem_.material, surface_energy, temperature_), surface_energy};
        }
        return found;
    }

    /// Weighted residuals: densities of all curves, then grain sizes.
    VectorXd residuals(const VectorXd& x) const {
        const KineticConstants tried = constants(x);
        VectorXd list(static_cast<Eigen::Index>(points_));
        Eigen::Index row = 0;
        std::vector<double> log_size(problem_.grains.size(), 0.0);  // mean over the firings
        for (std::size_t curve = 0; curve < firings_.size(); ++curve) {
            const FiringPrediction::Prediction predicted = firings_[curve].predict(tried);
            for (std::size_t point = 0; point < predicted.densities.size(); ++point)
                list[row++] = (problem_.curves[curve].density[point] - predicted.densities[point]) / density_error;
            for (std::size_t grain = 0; grain < log_size.size(); ++grain)
                log_size[grain] +=
                    std::log(predicted.course.diameter(problem_.grains[grain].density)) / static_cast<double>(firings_.size());
        }
        for (std::size_t grain = 0; grain < log_size.size(); ++grain)
            list[row++] = (std::log(problem_.grains[grain].diameter) - log_size[grain]) / problem_.grains[grain].error;
        return list;
    }

    /// ln Delta with which the densities are right in the mean, by halving; what else there is stays as in x.
    VectorXd started(VectorXd x) const {
        double low = -200.0, high = 0.0;
        for (int halving = 0; halving < halvings; ++halving) {
            x[0] = 0.5 * (low + high);
            (residuals(x).head(static_cast<Eigen::Index>(points_ - problem_.grains.size())).sum() > 0.0 ? low : high) = x[0];
        }
        return x;
    }

    bool beyond(const VectorXd& x) const {
        const KineticConstants found = constants(x);
        return std::ranges::any_of(firings_, [&](const FiringPrediction& firing) { return firing.predict(found).beyond; });
    }

   private:
    const KineticProblem& problem_;
    double temperature_;
    bool coarsens_;
    std::vector<FiringPrediction> firings_;
    std::size_t points_ = 0;
};

/// The residuals as a function of the first variables, the others held.
struct Residuals : Eigen::DenseFunctor<double> {
    const Search& search;
    VectorXd held;

    Residuals(const Search& search_, VectorXd held_, int free)
        : DenseFunctor(free, static_cast<int>(search_.points())), search(search_), held(std::move(held_)) {}

    VectorXd whole(const VectorXd& x) const {
        VectorXd all = held;
        all.head(x.size()) = x;
        return all;
    }

    int operator()(const VectorXd& x, VectorXd& values) const {
        values = search.residuals(whole(x));
        return values.allFinite() ? 0 : -1;
    }
};

using Differentiable = Eigen::NumericalDiff<Residuals, Eigen::Central>;

/// Best values of the first `free` variables, and the sum of squares there.
std::pair<VectorXd, double> minimised(const Search& search, const VectorXd& start, int free) {
    const Residuals problem(search, start, free);
    Differentiable functor(problem);
    Eigen::LevenbergMarquardt<Differentiable> solver(functor);
    solver.setFtol(tolerance);
    solver.setXtol(tolerance);
    VectorXd x = start.head(free);
    solver.minimize(x);
    const VectorXd all = x.allFinite() ? problem.whole(x) : start;
    return {all, search.residuals(all).squaredNorm()};
}

/// Best fits along the ratio of D_s' to Delta.
struct Profile {
    std::vector<VectorXd> x;
    std::vector<double> squares;

    std::size_t best() const { return static_cast<std::size_t>(std::ranges::min_element(squares) - squares.begin()); }

    /// Puts a fit in its place.
    void insert(const VectorXd& found, double sum) {
        const auto place = std::ranges::find_if(x, [&](const VectorXd& each) { return each[2] > found[2]; }) - x.begin();
        x.insert(x.begin() + place, found);
        squares.insert(squares.begin() + place, sum);
    }
};

/// Where to begin: the best of evenly spaced activation energies, each with the diffusion that is right in the mean. A fit from
/// elsewhere may end where all bodies are dense, and nothing changes with the constants.
VectorXd start_of(const Search& search, VectorXd x) {
    VectorXd best = x;
    double least = std::numeric_limits<double>::infinity();
    for (double energy = min_start; energy <= max_start; energy += start_step) {
        x[1] = energy / energy_unit;
        x = search.started(x);
        const double squares = search.residuals(x).squaredNorm();
        if (squares < least) {
            least = squares;
            best = x;
        }
    }
    return best;
}

Profile profile_of(const Search& search, VectorXd x, double low, double high) {
    Profile profile;
    profile.x.resize(profile_points);
    profile.squares.resize(profile_points);
    const auto ratio = [&](std::size_t point) {
        return low + (high - low) * static_cast<double>(point) / static_cast<double>(profile_points - 1);
    };
    std::ranges::fill(profile.squares, std::numeric_limits<double>::infinity());
    const auto fit = [&](std::size_t point, VectorXd from) {
        from[2] = ratio(point);
        const auto [found, squares] = minimised(search, from, 2);
        if (squares >= profile.squares[point]) return;
        profile.x[point] = found;
        profile.squares[point] = squares;
    };
    // From several beginnings, and from each point on to its neighbours, there and back.
    for (std::size_t point = 0; point < profile_points; point += profile_points / 4) {
        x[2] = ratio(point);
        fit(point, start_of(search, x));
    }
    for (std::size_t point = 1; point < profile_points; ++point) fit(point, profile.x[point - 1]);
    for (std::size_t point = profile_points - 1; point-- > 0;) fit(point, profile.x[point + 1]);
    return profile;
}

/// ln D_s' at the ends of where the sum of squares is below a limit, straight between the points of the profile.
std::pair<double, double> interval_of(const Profile& profile, double limit) {
    const auto surface = [&](std::size_t point) { return profile.x[point][0] + profile.x[point][2]; };
    const std::size_t best = profile.best();
    const auto edge = [&](std::size_t inside, std::size_t outside) {
        const double part = (limit - profile.squares[inside]) / (profile.squares[outside] - profile.squares[inside]);
        return surface(inside) + std::clamp(part, 0.0, 1.0) * (surface(outside) - surface(inside));
    };
    std::size_t low = best, high = best;
    while (low > 0 && profile.squares[low] <= limit) --low;
    while (high + 1 < profile.x.size() && profile.squares[high] <= limit) ++high;
    const bool open_below = profile.squares[low] <= limit, open_above = profile.squares[high] <= limit;
    return {open_below ? surface(low) : edge(low + 1, low), open_above ? surface(high) : edge(high - 1, high)};
}

Eigen::MatrixXd jacobian_at(const Search& search, const VectorXd& x, int free) {
    Differentiable functor(Residuals(search, x, free));
    Eigen::MatrixXd jacobian(static_cast<Eigen::Index>(search.points()), free);
    functor.df(x.head(free), jacobian);
    return jacobian;
}

/// Covariance of ln Delta, the activation energy and ln D_s'.
Eigen::MatrixXd covariance_of(const Eigen::MatrixXd& jacobian, double squares, std::size_t freedom) {
    const Eigen::MatrixXd normal = jacobian.transpose() * jacobian;
    Eigen::MatrixXd turned = Eigen::MatrixXd::Identity(normal.rows(), normal.rows());
    turned(1, 1) = energy_unit;
    if (normal.rows() == 3) turned(2, 0) = 1.0;  // ln D_s' = ln Delta + ln of the ratio
    return squares / static_cast<double>(freedom) * (turned * normal.inverse() * turned.transpose());
}

/// Moves the reference temperature to where Delta and the activation energy do not correlate, but no further than by a half.
void uncorrelate(KineticFit& fit, const Material& material) {
    Eigen::MatrixXd& covariance = *fit.covariance;
    const double before = fit.reference_temperature;
    const double shift = gas_constant * covariance(0, 1) / covariance(1, 1);  // of 1/T
    const double after = 1.0 / std::clamp(1.0 / before + shift, 0.67 / before, 2.0 / before);
    Eigen::MatrixXd turned = Eigen::MatrixXd::Identity(covariance.rows(), covariance.rows());
    turned(0, 1) = (1.0 / before - 1.0 / after) / gas_constant;
    covariance = turned * covariance * turned.transpose();
    const auto ratio = [&](double energy) { return activation(material, energy, after) / activation(material, energy, before); };
    fit.reference_temperature = after;
    fit.diffusion *= ratio(fit.constants.boundary.activation_energy);
    if (!fit.constants.surface) return;
    const double factor = ratio(fit.constants.surface->activation_energy);
    fit.surface_diffusion *= factor;
    fit.surface_interval->first *= factor;
    fit.surface_interval->second *= factor;
}

}  // namespace

KineticFit fit_kinetics(const DensificationModel& model, const KineticProblem& problem) {
    const Search search(model, problem);
    const std::size_t wanted = model.coarsens() ? 3 : 2;
    if (search.points() < wanted)
        throw Error("there are " + std::to_string(search.points()) + " measured points, and " + std::to_string(wanted) +
                    " constants to find");
    KineticFit fit;
    VectorXd x(3);
    x.setZero();
    double squares = 0.0;
    int free = 2;
    std::optional<Profile> profile;
    if (model.coarsens()) {
        const double low = std::log(problem.min_ratio), high = std::log(problem.max_ratio * beyond_runs);
        profile = profile_of(search, x, low, high);
        const std::size_t best = profile->best();
        std::tie(x, squares) = minimised(search, profile->x[best], 3);
        fit.surface_at_bound = !(x[2] > low && x[2] < high && squares <= profile->squares[best]);
        if (fit.surface_at_bound) {
            x = profile->x[best];
            squares = profile->squares[best];
        } else {
            profile->insert(x, squares);
        }
        free = fit.surface_at_bound ? 2 : 3;
    } else {
        std::tie(x, squares) = minimised(search, start_of(search, x), 2);
    }
    fit.constants = search.constants(x);
    fit.reference_temperature = search.reference_temperature();
    fit.diffusion = std::exp(x[0]);
    fit.surface_diffusion = model.coarsens() ? std::exp(x[0] + x[2]) : 0.0;
    fit.degrees_of_freedom = search.points() - static_cast<std::size_t>(free);
    if (fit.degrees_of_freedom > 0) {
        fit.covariance = covariance_of(jacobian_at(search, x, free), squares, fit.degrees_of_freedom);
        if (!fit.covariance->allFinite()) fit.covariance.reset();  // the curves do not tell the constants at all
    }
    if (fit.covariance) {
        if (profile) {
            const double t = student_factor(fit.degrees_of_freedom, confidence);
            const auto [low, high] =
                interval_of(*profile, squares * (1.0 + t * t / static_cast<double>(fit.degrees_of_freedom)));
            fit.surface_interval = {std::exp(low), std::exp(high)};
        }
        uncorrelate(fit, problem.material);
    }
    const VectorXd residuals = search.residuals(x);
    Eigen::Index row = 0;
    for (const DensityCurve& curve : problem.curves) {
        fit.residuals.emplace_back();
        for (std::size_t point = 0; point < curve.size(); ++point) fit.residuals.back().push_back(density_error * residuals[row++]);
    }
    fit.beyond = search.beyond(x);
    return fit;
}

}  // namespace kiln::analysis
