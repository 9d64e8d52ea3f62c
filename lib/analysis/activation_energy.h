// activation_energy.h: activation energies out of measured densities, without a model of the body.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "analysis/density_curve.h"

namespace kiln::analysis {

/// An energy and its standard error, J/mol; the error is NaN where it is not known.
struct Energy {
    double value = 0.0;
    double error = std::numeric_limits<double>::quiet_NaN();
};

/// At one density.
struct IsoDensity {
    double density;
    Energy energy;
    std::size_t curves;
};

/// ln(T d(density)/dt) against 1/T at each density: the slope is -Q/R where all bodies of one density differ by their temperature
/// alone. Source: J. Wang & R. Raj, J. Am. Ceram. Soc. 73 (1990) 1172. The error is that of the straight line, NaN for two curves.
/// Densities that fewer than two curves pass at different temperatures are left out.
std::vector<IsoDensity> iso_density_energies(const std::vector<DensityCurve>& curves, const std::vector<double>& densities);

/// How far the curves are from one: with Theta = integral of exp(-Q/RT)/T dt up to a density, the root of the mean square, over
/// densities and curves, of ln Theta less its mean at the density. energy: Q, J/mol. Curves that do not pass a density are left out
/// there. NaN if no two curves pass one density.
double master_curve_width(const std::vector<DensityCurve>& curves, const std::vector<double>& densities, double energy);

/// The energy at which the curves come nearest to one master sintering curve.
struct MasterCurve {
    Energy energy;
    double width = 0.0;      // at that energy
    std::string error_from;  // what was left out in turn for the error: "curves" or "densities"
};

inline constexpr double min_energy = 20e3, max_energy = 2000e3;  // J/mol, between which the narrowest one is sought

/// Source: H. Su & D. L. Johnson, J. Am. Ceram. Soc. 79 (1996) 3211. The error is the jackknife's (leave one curve out in turn; of
/// two curves, one density). Throws Error if no two curves pass one density.
MasterCurve narrowest_master_curve(const std::vector<DensityCurve>& curves, const std::vector<double>& densities);

}  // namespace kiln::analysis
