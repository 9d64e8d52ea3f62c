// density_curve.h: the density of a body along a firing, as a dilatometer measures it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "physics/schedule.h"

namespace kiln::analysis {

/// Relative density at times of a firing.
struct DensityCurve {
    std::string name;
    physics::Schedule schedule;
    std::vector<double> time;     // s, on the clock of the schedule, ascending
    std::vector<double> density;  // relative

    std::size_t size() const { return time.size(); }
};

/// Where a curve passes a density: by the least squares cubic through its points nearby (those within 0.03 of the density, four at
/// least), so that the noise of a dilatometer does not make its derivative.
struct Crossing {
    double time;         // s
    double temperature;  // K
    double rate;         // of the relative density, 1/s
};

/// Nothing where the curve does not reach the density, begins above it, has fewer than four points, or does not rise there.
std::optional<Crossing> crossing(const DensityCurve& curve, double density);

/// Evenly spaced densities that all curves pass, away from the ends by 5 % of the range they have in common. Nothing if there is
/// no such range.
std::vector<double> common_densities(const std::vector<DensityCurve>& curves, std::size_t count);

}  // namespace kiln::analysis
