// simulated_run.cpp: rates at which a run's theta and sigma grow.
#include "analysis/simulated_run.h"

#include "physics/diffusion.h"
#include "physics/materials.h"

namespace kiln::analysis {

double boundary_rate(const Material& material, double temperature) {
    return physics::required(material.surface_energy, material, "surface_energy") *
           physics::diffusion_parameter_of(material, temperature);
}

double surface_rate(const Material& material, const Activated& surface, double temperature) {
    return physics::required(material.surface_energy, material, "surface_energy") *
           physics::diffusion_parameter(physics::required(material.atomic_volume, material, "atomic_volume"), surface.prefactor,
                                        surface.activation_energy, temperature);
}

}  // namespace kiln::analysis
