// quantity.cpp: the table of units and the parser of quantities.
#include "io/quantity.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/types.h"

namespace kiln::io {

namespace {

struct Unit {
    Dimension dimension;
    const char* name;
    Scale scale;
};

constexpr double zero_celsius = 273.15;  // K, definition of the Celsius scale

constexpr Unit units[] = {
    {Dimension::fraction, "%", 1.0, 1e2},
    {Dimension::fraction, "percent", 1.0, 1e2},
    {Dimension::length, "m", 1.0},
    {Dimension::length, "cm", 1.0, 1e2},
    {Dimension::length, "mm", 1.0, 1e3},
    {Dimension::length, "um", 1.0, 1e6},
    {Dimension::length, "nm", 1.0, 1e9},
    {Dimension::area, "m2", 1.0},
    {Dimension::area, "mm2", 1.0, 1e6},
    {Dimension::volume, "m3", 1.0},
    {Dimension::volume, "l", 1.0, 1e3},
    {Dimension::time, "s", 1.0},
    {Dimension::time, "ms", 1.0, 1e3},
    {Dimension::time, "us", 1.0, 1e6},
    {Dimension::time, "min", 60.0},
    {Dimension::time, "h", 3600.0},
    {Dimension::time, "d", 86400.0},
    {Dimension::temperature, "K", 1.0},
    {Dimension::temperature, "C", 1.0, 1.0, zero_celsius},
    {Dimension::heating_rate, "K/s", 1.0},
    {Dimension::heating_rate, "K/min", 1.0, 60.0},
    {Dimension::heating_rate, "K/h", 1.0, 3600.0},
    {Dimension::heating_rate, "C/s", 1.0},
    {Dimension::heating_rate, "C/min", 1.0, 60.0},
    {Dimension::heating_rate, "C/h", 1.0, 3600.0},
    {Dimension::pressure, "Pa", 1.0},
    {Dimension::pressure, "kPa", 1e3},
    {Dimension::pressure, "MPa", 1e6},
    {Dimension::pressure, "GPa", 1e9},
    {Dimension::pressure, "N/mm2", 1e6},
    {Dimension::pressure, "kN/mm2", 1e9},
    {Dimension::force, "N", 1.0},
    {Dimension::force, "kN", 1e3},
    {Dimension::force, "mN", 1.0, 1e3},
    {Dimension::force, "uN", 1.0, 1e6},
    {Dimension::force, "nN", 1.0, 1e9},
    {Dimension::velocity, "m/s", 1.0},
    {Dimension::velocity, "mm/s", 1.0, 1e3},
    {Dimension::velocity, "um/s", 1.0, 1e6},
    {Dimension::velocity, "nm/s", 1.0, 1e9},
    {Dimension::surface_energy, "J/m2", 1.0},
    {Dimension::surface_energy, "mJ/m2", 1.0, 1e3},
    {Dimension::molar_energy, "J/mol", 1.0},
    {Dimension::molar_energy, "kJ/mol", 1e3},
    {Dimension::mass_density, "kg/m3", 1.0},
    {Dimension::mass_density, "g/cm3", 1e3},
    {Dimension::angle, "rad", 1.0},
    {Dimension::angle, "deg", std::numbers::pi, 180.0},
    {Dimension::diffusion_volume, "m3/s", 1.0},
    {Dimension::compliance, "m/N", 1.0},
    {Dimension::compliance, "mm/N", 1.0, 1e3},
    {Dimension::compliance, "um/N", 1.0, 1e6},
    {Dimension::compliance, "nm/N", 1.0, 1e9},
    {Dimension::compliance, "mm/kN", 1.0, 1e6},
    {Dimension::conductivity, "W/m/K", 1.0},
    {Dimension::area_resistance, "m2K/W", 1.0},
    {Dimension::area_resistance, "mm2K/W", 1.0, 1e6},
};

constexpr double room_temperature = 298.15;  // K, what "RT" says: 25 C

/// Signs that keyboards, spreadsheets and instruments write, and how the table above spells them.
constexpr std::pair<std::string_view, std::string_view> spellings[] = {
    {"\u00b5", "u"},      // the micro sign
    {"\u03bc", "u"},      // the Greek letter
    {"\u2103", "C"},      // degree Celsius in one sign
    {"\u00b0C", "C"},
    {"\u00baC", "C"},     // an ordinal sign, of keyboards that have no degree sign
    {"degC", "C"},
    {"deg C", "C"},
    {"\u00b0 C", "C"},
    {"\u00b0", "deg"},
    {"\u00b2", "2"},
    {"\u00b3", "3"},
    {"^", ""},
};

std::string spelled(std::string_view given) {
    std::string name(given);
    for (const auto& [sign, plain] : spellings)
        for (std::size_t at = name.find(sign); at != std::string::npos; at = name.find(sign, at + plain.size()))
            name.replace(at, sign.size(), plain);
    return name;
}

}  // namespace

bool is_unit(std::string_view text) {
    const std::string name = spelled(text);
    return std::ranges::any_of(units, [&](const Unit& unit) { return name == unit.name; });
}

std::optional<Scale> scale_of(std::string_view unit, Dimension dimension) {
    if (unit.empty() && (dimension == Dimension::none || dimension == Dimension::fraction)) return Scale{1.0};
    const std::string name = spelled(unit);
    const auto found =
        std::ranges::find_if(units, [&](const Unit& each) { return each.dimension == dimension && name == each.name; });
    return found == std::end(units) ? std::nullopt : std::optional(found->scale);
}

std::string known_units(Dimension dimension) {
    std::string list;
    for (const Unit& unit : units)
        if (unit.dimension == dimension) list += (list.empty() ? "" : ", ") + std::string(unit.name);
    return list;
}

double parse_quantity(std::string_view text, Dimension dimension) {
    const std::string given = std::string("'").append(text) + "'";
    while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
    while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
    if (dimension == Dimension::temperature && text == "RT") return room_temperature;
    double number = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error == std::errc::result_out_of_range) throw TextError(given + " is out of the range of numbers");
    if (error != std::errc() || !std::isfinite(number)) throw TextError(given + " is not a number");
    std::string_view unit = text.substr(static_cast<std::size_t>(end - text.data()));
    while (!unit.empty() && unit.front() == ' ') unit.remove_prefix(1);
    const auto scale = scale_of(unit, dimension);
    if (!scale && dimension == Dimension::none) throw TextError(given + " has a unit where a plain number is required");
    if (!scale)
        throw TextError(given + (unit.empty() ? " has no unit" : " has no unit of the right kind") +
                        "; known here: " + known_units(dimension));
    const double value = scale->si(number);
    if (!std::isfinite(value)) throw TextError(given + " is out of the range of numbers");
    if (dimension == Dimension::temperature && value <= 0.0) throw TextError(given + " is not above absolute zero");
    return value;
}

}  // namespace kiln::io
