// densification_model.h: how the density of a simulated body follows from the diffusion that has passed, out of a few runs.
#pragma once

#include <vector>

#include "analysis/activated_time.h"
#include "analysis/monotone_curve.h"
#include "analysis/simulated_run.h"

namespace kiln::analysis {

/// A body's way along a firing: what theta and which grains belong to a density.
class Course {
   public:
    /// density ascending; theta, m4: reached there; diameter, m: mean of the grains there, NaN where it is not known.
    Course(const std::vector<double>& density, const std::vector<double>& theta, const std::vector<double>& diameter);

    double density(double theta) const { return density_.at(std::cbrt(theta)); }
    double diameter(double density) const { return diameter_.at(density); }

    /// True once theta is more than the runs have reached.
    bool beyond(double theta) const { return theta > end_; }

   private:
    double end_;
    MonotoneCurve density_, diameter_;  // density against the cube root of theta, as overlaps grow; diameter against density
};

/// Without coarsening the density is a function of theta = integral of Delta gamma dt alone: one run gives it for all firings of
/// its body (the master sintering curve). With coarsening it also depends on sigma = integral of D_s' gamma dt, and on when that
/// passed. All that matters of the past is taken to be the density and sigma themselves: the theta that a body needs from one
/// density to the next is interpolated, straight in sigma, between runs of the body with other ratios of D_s' to Delta. Straight,
/// because a body of one shape needs a theta in proportion to the fourth power of its grains' size (C. Herring, J. Appl. Phys. 21
/// (1950) 301), and that power grows in proportion to sigma. This is an assumption; a run at the constants found says how good it
/// was.
class DensificationModel {
   public:
    /// runs: of one body. Throws Error for none, for runs that start at different densities, if none of them densifies, for some
    /// with and some without coarsening, and for materials that lack what theta needs.
    explicit DensificationModel(const std::vector<SimulatedRun>& runs);

    bool coarsens() const { return coarsens_; }

    /// Along a firing with theta, and sigma where the model coarsens (else nullptr).
    Course course(const ActivatedTime& theta, const ActivatedTime* sigma) const;

    double start_density() const { return density_.front(); }
    double end_density() const { return density_.back(); }

   private:
    /// What a run says of the way from one density of the grid to the next.
    struct Sample {
        double sigma;     // half way, m4
        double theta;     // that passes, m4
        double diameter;  // at the end, m; NaN if it is not known
    };

    void add(const SimulatedRun& run);
    void order();
    Sample at(std::size_t span, double sigma) const;

    bool coarsens_ = false;
    double start_diameter_ = 0.0;               // m; NaN if it is not known
    std::vector<double> density_;               // grid, from the start on
    std::vector<std::vector<Sample>> samples_;  // of each span of the grid, by ascending sigma
};

}  // namespace kiln::analysis
