// kinetics.h: what pairs of materials bring to sintering: surface energy, diffusion over a span of time, the limit of the neck.
#pragma once

#include <optional>
#include <string>
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

    /// True for a pair that does not diffuse, or over the whole schedule by less than `rigid_fraction` of the fastest pair: once it
    /// touches it sticks. The overlap of a pair grows with the cube root of its diffusion, so such a pair would come to less than
    /// 5e-3 of the fastest one's.
    bool rigid(std::size_t row) const { return rigid_[row]; }
    bool any_rigid() const { return any_rigid_; }
    static constexpr double rigid_fraction = 1e-7;

    /// Pairs of materials that diffuse and are rigid all the same: their names, and their diffusion over that of the fastest.
    struct SlowPair {
        std::string first, second;
        double fraction;
    };
    const std::vector<SlowPair>& taken_as_rigid() const { return taken_as_rigid_; }

    /// Largest contact radius over the smaller particle's radius, sin(psi/2) of the dihedral angle psi; infinity where none is
    /// given.
    double neck_limit(std::size_t row) const { return neck_limit_[row]; }

    /// Delta of each pair of materials at a temperature (K), m5/(N s); zero where no particle is of one of them.
    std::vector<double> diffusion_at(double temperature) const;

    /// Delta of the fastest pair over that of each pair of materials at a temperature (K), whatever their size; infinity for one
    /// that does not diffuse.
    std::vector<double> slowness_at(double temperature) const;

    /// Integral of Delta over time from `from` to `until` (s) for each pair of materials, m5/N. That of a pair which is not rigid
    /// is at least rigid_fraction of the largest: a firing may have spans in which a pair is slower than that.
    std::vector<double> diffusion_over(double from, double until) const;

    /// Equivalent time between two times, s.
    double equivalent(double from, double until) const;

    /// The time at which `equivalent` seconds of equivalent time have passed since `from`, s; infinity if they never will.
    double after(double from, double equivalent) const;

    /// Integral of Delta of the fastest pair over equivalent time, m5/(N s): its Delta at the highest temperature.
    double fastest() const { return fastest_; }

   private:
    double diffusion(std::size_t row, double temperature) const;
    bool diffuses(std::size_t row) const;
    void find_rigid(const Particles& particles);

    physics::Schedule schedule_;
    std::size_t materials_;
    std::vector<Material> material_;
    std::vector<double> energy_, neck_limit_;
    std::vector<std::optional<double>> given_;  // Delta of pairs that the state gives
    std::vector<bool> present_, rigid_;  // of each pair: particles of both are there; rigid
    bool any_rigid_ = false;
    std::vector<SlowPair> taken_as_rigid_;
    std::size_t fastest_row_ = 0;
    double fastest_ = 0.0;
    std::vector<double> times_;  // ends of the schedule's panels, s; none for a hold without end
};

}  // namespace kiln::sintering
