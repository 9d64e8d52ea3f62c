// diffusion.h: thermally activated motion, the only place where temperature enters sintering.
#pragma once

#include <cmath>

namespace kiln::physics {

inline constexpr double boltzmann_constant = 1.380649e-23;  // J/K, exact in the SI since 2019
inline constexpr double gas_constant = 8.314462618;         // J/(mol K), exact product of k_B and N_A

/// Diffusion parameter Delta = Omega/(k_B T) delta D_0b exp(-Q_b/(R T)), m5/(N s).
///
/// With delta_s D_0s and the activation energy of surface diffusion it is D_s' of coarsening, in the same unit, m6/(J s).
/// Source: Bouvard & McMeeking 1996; Parhami & McMeeking 1998, the Delta_b of Dosta et al. 2017, Eq. 1.
/// atomic_volume Omega, m3; prefactor delta D_0b, m3/s; activation_energy Q_b, J/mol; temperature T, K.
inline double diffusion_parameter(double atomic_volume, double prefactor, double activation_energy, double temperature) {
    return atomic_volume / (boltzmann_constant * temperature) * prefactor *
           std::exp(-activation_energy / (gas_constant * temperature));
}

/// Mobility of a grain boundary M = M_0 exp(-Q_m/(R T)), m4/(J s); prefactor M_0, m4/(J s); activation_energy Q_m, J/mol.
inline double boundary_mobility(double prefactor, double activation_energy, double temperature) {
    return prefactor * std::exp(-activation_energy / (gas_constant * temperature));
}

/// Delta of a contact of two materials: harmonic mean, that is, half the path lies in each. m5/(N s).
inline double mixed_diffusion_parameter(double first, double second) {
    return first + second > 0.0 ? 2.0 * first * second / (first + second) : 0.0;
}

/// Surface energy of a contact of two materials, geometric mean, J/m2.
inline double mixed_surface_energy(double first, double second) { return std::sqrt(first * second); }

}  // namespace kiln::physics
