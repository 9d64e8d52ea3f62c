// simulated_run.h: the density of a simulated body along its firing.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/state.h"
#include "physics/schedule.h"

namespace kiln::analysis {

/// A thermally activated coefficient prefactor exp(-activation_energy/(R T)).
struct Activated {
    double prefactor;          // of delta D, m3/s
    double activation_energy;  // J/mol
};

/// What is known of a run of `sinter`: its body at the start, and after each step.
struct SimulatedRun {
    std::string name;
    Material material;
    std::optional<Activated> surface;    // delta_s D_s, where grains exchanged volume by surface diffusion
    physics::Schedule schedule;
    std::vector<double> time;            // s, on the clock of the schedule; the first is that of the start
    std::vector<double> density;         // relative, at those times
    std::vector<double> grain_diameter;  // m, mean, at those times; empty where it is not known
};

/// Delta gamma of a material at a temperature (K), m4/s; its integral over time is theta. Throws Error that names a missing key.
double boundary_rate(const Material& material, double temperature);

/// D_s' gamma with D_s' = Omega delta_s D_s/(k_B T), m4/s; its integral over time is sigma.
double surface_rate(const Material& material, const Activated& surface, double temperature);

}  // namespace kiln::analysis
