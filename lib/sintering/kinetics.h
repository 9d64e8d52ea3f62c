// kinetics.h: what pairs of materials bring to sintering: surface energy, diffusion over a span of time, the limit of the neck.
#pragma once

#include <vector>

#include "core/neighbours.h"
#include "core/state.h"
#include "physics/schedule.h"

namespace kiln::sintering {

/// Tables over pairs of materials. Steps are measured by equivalent time: that at the highest temperature of the schedule in which
/// the fastest pair would have diffused as much. Under a constant temperature it is time itself.
class Kinetics {
   public:
    /// Throws Error where a material lacks what the contact law needs, or if nothing diffuses at all.
    Kinetics(const State& state, const physics::Schedule& schedule);

    const physics::Schedule& schedule() const { return schedule_; }

    /// Row of a pair of materials in the tables.
    std::size_t row(std::int32_t a, std::int32_t b) const {
        return static_cast<std::size_t>(a) * materials_ + static_cast<std::size_t>(b);
    }

    /// The same of the two particles of a pair.
    std::size_t row(const Particles& particles, const Pair& pair) const {
        return row(particles.material[static_cast<std::size_t>(pair.i)], particles.material[static_cast<std::size_t>(pair.j)]);
    }

    double surface_energy(std::size_t row) const { return energy_[row]; }  // J/m2

    /// True for a pair that does not diffuse: once it touches it sticks.
    bool rigid(std::size_t row) const { return rigid_[row]; }
    bool any_rigid() const { return any_rigid_; }

    /// Largest contact radius over the smaller particle's radius, sin(psi/2) of the dihedral angle psi; infinity where none is
    /// given.
    double neck_limit(std::size_t row) const { return neck_limit_[row]; }

    /// Delta of each pair of materials at a temperature (K), m5/(N s).
    std::vector<double> diffusion_at(double temperature) const;

    /// Integral of Delta over time from `from` to `until` (s) for each pair of materials, m5/N.
    std::vector<double> diffusion_over(double from, double until) const;

    /// Equivalent time between two times, s.
    double equivalent(double from, double until) const;

    /// The time at which `equivalent` seconds of equivalent time have passed since `from`, s; infinity if they never will.
    double after(double from, double equivalent) const;

    /// Integral of Delta of the fastest pair over equivalent time, m5/(N s): its Delta at the highest temperature.
    double fastest() const { return fastest_; }

   private:
    double diffusion(std::size_t row, double temperature) const;

    physics::Schedule schedule_;
    std::size_t materials_;
    std::vector<Material> material_;
    std::vector<double> energy_, neck_limit_;
    std::vector<std::optional<double>> given_;  // Delta of pairs that the state gives
    std::vector<bool> rigid_;
    bool any_rigid_ = false;
    std::size_t fastest_row_ = 0;
    double fastest_ = 0.0;
    std::vector<double> times_;  // ends of the schedule's panels, s; none for a hold without end
};

}  // namespace kiln::sintering
