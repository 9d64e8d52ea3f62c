// conduction.cpp: resistances of a neck and of the bulk behind it, and what bounds that of a packing.
#include "physics/conduction.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kiln::physics {

namespace {

using std::numbers::pi;

constexpr double min_constriction = 1e-3;  // of a side's resistance, so that none is without any
constexpr double bulk_factor = 0.94;
constexpr double alignment_power = 3.0 / 4.0;

}  // namespace

NeckSide neck_side(double conductivity, double sphere_radius, double neck_radius, double neck_length) {
    const double R = sphere_radius, a = std::min(neck_radius, R), x = a / R, open = std::sqrt((1.0 - x) * (1.0 + x));
    const double s = R * open, half = 0.5 * std::max(neck_length, 1e-3 * a), area = pi * a * a;
    const double cubic = 1.0 + x * (-0.678 + x * (1.048 - 0.602 * x));
    const double resistance = open / (4.0 * conductivity * a * cubic) + half / (conductivity * area);
    const double length = s + half, volume = pi * s * (R * R - s * s / 3.0) + area * half;
    return {length, std::max(min_constriction * resistance, resistance - length * length / (conductivity * volume))};
}

double bulk_resistance(double conductivity, double length, double volume, double alignment) {
    return bulk_factor * std::pow(std::max(1.0, alignment), alignment_power) * 2.0 * length * length / (conductivity * volume);
}

double conductivity_bound(double solid_fraction) { return 2.0 * solid_fraction / (3.0 - solid_fraction); }

}  // namespace kiln::physics
