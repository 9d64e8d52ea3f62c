// explicit_sintering.h: sintering with inertia, mass-scaled and integrated explicitly, as in Dosta et al. 2017: the reference
// method.
#pragma once

#include "core/grouping.h"
#include "sintering/sintering.h"

namespace kiln::sintering {

/// Central differences of S m dv/dt = sum of contact forces (Eq. 1), with velocities half a step behind the positions. The true
/// inertia (S = 1) is of no account, and the time step would be 1e-19 s; a mass scaled by S = 1e20 makes steps affordable and the
/// motion late. The strain rates of a periodic box have the inertia of each particle moving by its own diameter.
class ExplicitSintering : public SinteringMethod {
   public:
    /// Throws Error for what the method has no law for: pairs that do not diffuse, a dihedral limit, a material without density.
    ExplicitSintering(State state, const SinteringSettings& settings);

    /// Steps until the density has changed a little or some hundreds of them are done.
    StepRecord advance(double latest_time, double highest_density) override;

   private:
    struct PairForce {
        Vec3 force = Vec3::Zero();  // on i, towards j, N
        double viscosity = 0.0;     // normal, N s/m
    };
    /// Sums over all contacts, per axis.
    struct BoxForce {
        Vec3 force = Vec3::Zero();      // of the contacts' force times their vector, J
        Vec3 viscosity = Vec3::Zero();  // of the contacts' viscosity times the square of their vector, J s
    };
    Numbers numbers() const override;
    std::vector<NamedArray> arrays() const override;
    void take_up(const Numbers& numbers, const std::vector<NamedArray>& arrays) override;

    void list_pairs();
    PairForce pair_force(const Pair& pair, const std::vector<double>& diffusion) const;
    BoxForce find_forces(const std::vector<double>& diffusion);
    double stable_step(const BoxForce& box) const;
    void accelerate(const BoxForce& box, double step);
    Motion motion_over(double step) const;
    double shortened(double step, double log_change) const;
    void step_once(double latest_time, double highest_density, StepRecord& record);

    std::vector<double> mass_;          // kg, scaled
    Vec3 box_inertia_ = Vec3::Zero();   // kg m2, of the strain rates
    std::vector<Pair> pairs_;
    std::vector<std::size_t> first_row_;  // of the pairs whose first particle is this one or a later one
    Grouping<std::int32_t> sides_;  // of each particle: pair, or -1 - pair where the particle is its second
    std::vector<PairForce> force_;      // a row a pair
    std::vector<Vec3> velocity_, acceleration_;  // m/s, relative to the affine flow; m/s2
    std::vector<double> damping_;       // of each particle, sum of viscosities over mass, 1/s
    Vec3 strain_rate_ = Vec3::Zero();   // 1/s
};

}  // namespace kiln::sintering
