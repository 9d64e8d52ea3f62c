// kinetic_fit.h: constants of diffusion with which a simulated body densifies as a measured one.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "analysis/densification_model.h"
#include "analysis/density_curve.h"

namespace kiln::analysis {

/// The constants that are fitted. Surface energy, atomic volume and the activation energy of surface diffusion stay as they are.
struct KineticConstants {
    Activated boundary;                // delta D_b, m3/s
    std::optional<Activated> surface;  // delta_s D_s, m3/s, where the model coarsens
};

/// Densities and grains of a body of the model along one firing.
class FiringPrediction {
   public:
    /// times, s, on the clock of the schedule, ascending.
    FiringPrediction(const DensificationModel& model, const Material& material, const physics::Schedule& schedule,
                     std::vector<double> times);

    /// From now on the predictions are those of this run and what the model says of a change of its constants to others. The run
    /// has the same firing.
    void correct_by(const SimulatedRun& run);

    struct Prediction {
        std::vector<double> densities;  // at the times
        Course course;                  // of which the correction is no part
        bool beyond;                    // the runs of the model do not reach as far as the last of the times
    };

    Prediction predict(const KineticConstants& constants) const;
    std::vector<double> densities(const KineticConstants& constants) const { return predict(constants).densities; }

    /// Mean grain diameter at a density, m; NaN where the runs do not say.
    double diameter(const KineticConstants& constants, double density) const {
        return predict(constants).course.diameter(density);
    }

   private:
    template <typename Boundary, typename Surface>
    Prediction uncorrected(const Boundary& boundary, const Surface& surface) const;

    const DensificationModel& model_;
    Material material_;
    FiringPath path_;
    std::vector<double> times_;
    std::vector<double> correction_;  // of the density at each time
};

/// True if a run has the temperatures of a firing within `tolerance` (K) at all of its times.
bool follows(const SimulatedRun& run, const physics::Schedule& schedule, const std::vector<double>& times, double tolerance = 2.0);

/// A grain size that was measured.
struct GrainSize {
    double density;   // relative
    double diameter;  // m, mean
    double error;     // relative
};

/// What is fitted to what.
struct KineticProblem {
    std::vector<DensityCurve> curves;
    std::vector<const SimulatedRun*> runs;  // of each curve: one to correct by, or nullptr
    std::vector<GrainSize> grains;
    Material material;               // surface energy, atomic volume
    std::optional<Activated> surface;  // its activation energy stays
    double min_ratio = 0.0, max_ratio = 0.0;  // of D_s' to Delta at the reference temperature, between which it is sought
};

inline constexpr double density_error = 0.01;  // of a measured density beside a grain size of its own error

struct KineticFit {
    KineticConstants constants;
    double reference_temperature = 0.0;  // K; with errors that at which Delta and the activation energy do not correlate
    double diffusion = 0.0;              // Delta there, m5/(N s)
    double surface_diffusion = 0.0;      // D_s' there, m5/(N s)

    /// Of ln Delta there, the activation energy (J/mol), and ln D_s' there; nothing without degrees of freedom, or with D_s' at a
    /// bound of the search only of the first two.
    std::optional<Eigen::MatrixXd> covariance;
    std::size_t degrees_of_freedom = 0;
    bool surface_at_bound = false;
    std::optional<std::pair<double, double>> surface_interval;  // of D_s' there with 95 % confidence, by the sum of squares
    std::vector<std::vector<double>> residuals;                 // of each curve, measured less fitted density
    bool beyond = false;                                        // the runs do not reach as far as the curves
};

/// Mean over points of the highest temperature before each, K.
double reference_temperature(const std::vector<DensityCurve>& curves);

/// Least squares of the densities (each with an error of density_error) and the logarithms of grain sizes. Throws Error for fewer
/// points than constants.
KineticFit fit_kinetics(const DensificationModel& model, const KineticProblem& problem);

}  // namespace kiln::analysis
