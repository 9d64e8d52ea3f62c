// quantity.h: quantities with units as people write them, such as 50nm, 1200C, 10K/min; a number without its unit is an error.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace kiln::io {

enum class Dimension {
    none,              // plain number
    fraction,          // plain number, or % of it
    length,            // m
    area,              // m2
    volume,            // m3
    time,              // s
    temperature,       // K; C is converted
    heating_rate,      // K/s
    pressure,          // Pa
    force,             // N
    velocity,          // m/s
    surface_energy,    // J/m2
    molar_energy,      // J/mol
    mass_density,      // kg/m3
    angle,             // rad
    diffusion_volume,  // m3/s, grain boundary width times diffusivity
    compliance,        // m/N
    conductivity,      // W/(m K)
    area_resistance,   // m2 K/W, of an area to heat
};

/// SI value of a text such as "50nm", "1200°C" or "0.35 µm". Upper and lower case count; the degree sign, both micro signs and
/// superscripts are read as the units of the list are spelled, and RT is a temperature of 25 C. Throws TextError that says what was
/// given and which units are known.
double parse_quantity(std::string_view text, Dimension dimension);

/// What makes an SI value of a number of some unit.
struct Scale {
    double factor;         // SI value of one unit, times the divisor
    double divisor = 1.0;  // exact where the factor would not be: 100nm is 1e-7 and not its neighbour
    double offset = 0.0;   // SI value of zero units

    [[nodiscard]] double si(double number) const { return number * factor / divisor + offset; }
};

/// The scale of a unit as people write it; nothing if it is none of that dimension. A plain number has no unit, a fraction need not
/// have one.
std::optional<Scale> scale_of(std::string_view unit, Dimension dimension);

/// True for the name of a unit, whatever it measures.
bool is_unit(std::string_view text);

/// The units of a dimension, for help texts: "m, mm, um, nm".
std::string known_units(Dimension dimension);

}  // namespace kiln::io
