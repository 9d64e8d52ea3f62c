// units_test.cpp: every unit of the command line by its SI value, and what is no quantity.
#include <doctest/doctest.h>

#include <numbers>

#include "core/types.h"
#include "io/quantity.h"
#include "tests/physics/relative.h"

namespace {

using namespace kiln;
using namespace kiln::io;
using kiln::test::relative;

struct Case {
    Dimension dimension;
    const char* text;
    double value;  // SI
};

/// What is said of a text that is no quantity; empty where it is one.
std::string refusal(const std::string& text, Dimension dimension) {
    try {
        parse_quantity(text, dimension);
    } catch (const TextError& error) {
        return error.what();
    }
    return "";
}

TEST_CASE("every unit has its SI value, to the last bit") {
    const Case cases[] = {
        {Dimension::none, "0.5", 0.5},
        {Dimension::fraction, "0.79", 0.79},
        {Dimension::fraction, "79%", 0.79},
        {Dimension::fraction, "2percent", 0.02},
        {Dimension::length, "2m", 2.0},
        {Dimension::length, "5cm", 0.05},
        {Dimension::length, "3mm", 3e-3},
        {Dimension::length, "0.7um", 0.7e-6},
        {Dimension::length, "100nm", 1e-7},
        {Dimension::length, "1e-3m", 1e-3},
        {Dimension::area, "2m2", 2.0},
        {Dimension::area, "2mm2", 2e-6},
        {Dimension::volume, "2m3", 2.0},
        {Dimension::volume, "2l", 2e-3},
        {Dimension::time, "90s", 90.0},
        {Dimension::time, "7ms", 7e-3},
        {Dimension::time, "7us", 7e-6},
        {Dimension::time, "1d", 86400.0},
        {Dimension::time, "2min", 120.0},
        {Dimension::time, "1.5h", 5400.0},
        {Dimension::temperature, "1473K", 1473.0},
        {Dimension::temperature, "1200C", 1473.15},
        {Dimension::temperature, "-5C", 268.15},
        {Dimension::heating_rate, "2K/s", 2.0},
        {Dimension::heating_rate, "3K/min", 0.05},
        {Dimension::heating_rate, "36K/h", 0.01},
        {Dimension::heating_rate, "2C/s", 2.0},
        {Dimension::heating_rate, "3C/min", 0.05},
        {Dimension::heating_rate, "36C/h", 0.01},
        {Dimension::pressure, "1e5Pa", 1e5},
        {Dimension::pressure, "3kPa", 3e3},
        {Dimension::pressure, "150MPa", 150e6},
        {Dimension::pressure, "400GPa", 400e9},
        {Dimension::pressure, "2N/mm2", 2e6},
        {Dimension::pressure, "2kN/mm2", 2e9},
        {Dimension::force, "2N", 2.0},
        {Dimension::force, "2kN", 2e3},
        {Dimension::force, "3mN", 3e-3},
        {Dimension::force, "3uN", 3e-6},
        {Dimension::force, "3nN", 3e-9},
        {Dimension::velocity, "3m/s", 3.0},
        {Dimension::velocity, "3mm/s", 3e-3},
        {Dimension::velocity, "3um/s", 3e-6},
        {Dimension::velocity, "3nm/s", 3e-9},
        {Dimension::surface_energy, "1.1J/m2", 1.1},
        {Dimension::surface_energy, "905mJ/m2", 0.905},
        {Dimension::molar_energy, "475000J/mol", 475e3},
        {Dimension::molar_energy, "475kJ/mol", 475e3},
        {Dimension::mass_density, "3950kg/m3", 3950.0},
        {Dimension::mass_density, "3.95g/cm3", 3950.0},
        {Dimension::angle, "1.5rad", 1.5},
        {Dimension::angle, "180deg", std::numbers::pi},
        {Dimension::diffusion_volume, "1.3e-8m3/s", 1.3e-8},
        {Dimension::compliance, "3m/N", 3.0},
        {Dimension::compliance, "3mm/N", 3e-3},
        {Dimension::compliance, "3um/N", 3e-6},
        {Dimension::compliance, "3nm/N", 3e-9},
        {Dimension::compliance, "3mm/kN", 3e-6},
        {Dimension::conductivity, "30W/m/K", 30.0},
        {Dimension::area_resistance, "1e-8m2K/W", 1e-8},
        {Dimension::area_resistance, "10mm2K/W", 1e-5},
    };
    std::vector<std::string> tested;
    for (const Case& each : cases) {
        CAPTURE(each.text);
        CHECK(parse_quantity(each.text, each.dimension) == each.value);
        tested.push_back(each.text);
    }
    for (int dimension = 1; dimension <= static_cast<int>(Dimension::area_resistance); ++dimension) {
        std::istringstream known(known_units(static_cast<Dimension>(dimension)));
        for (std::string unit; std::getline(known >> std::ws, unit, ',');) {
            CAPTURE(unit);
            CHECK(std::any_of(tested.begin(), tested.end(), [&](const std::string& text) {
                return text.ends_with(unit) && text.size() > unit.size() &&
                       std::isdigit(static_cast<unsigned char>(text[text.size() - unit.size() - 1]));
            }));
        }
    }
}

TEST_CASE("units as keyboards and instruments write them: degree signs, both micro signs, superscripts; RT") {
    for (const char* text : {"25C", "25°C", "25 °C", "25 ° C", "25\u2103", "25\u00baC", "25degC", "25 deg C", "RT", " RT "}) {
        CAPTURE(text);
        CHECK(parse_quantity(text, Dimension::temperature) == 298.15);
    }
    for (const char* text : {"6C/min", "6°C/min", "6 \u2103/min", "6degC/min", "6K/min", "360C/h", "360°C/h", "0.1°C/s"}) {
        CAPTURE(text);
        CHECK(parse_quantity(text, Dimension::heating_rate) == relative(0.1, 1e-15));
    }
    for (const char* text : {"0.35um", "0.35\u00b5m", "0.35 \u03bcm"}) CHECK(parse_quantity(text, Dimension::length) == 0.35e-6);
    CHECK(parse_quantity("45°", Dimension::angle) == parse_quantity("45deg", Dimension::angle));
    CHECK(parse_quantity("3.95g/cm\u00b3", Dimension::mass_density) == 3950.0);
    CHECK(parse_quantity("1.1 J/m^2", Dimension::surface_energy) == 1.1);
    for (const char* text : {"25°F", "25°", "25", "rt", "25RT", "25c"}) CHECK(refusal(text, Dimension::temperature) != "");
    CHECK(refusal("25°", Dimension::temperature) == "'25°' has no unit of the right kind; known here: K, C");
    CHECK(refusal("RT", Dimension::time) != "");
}

TEST_CASE("blanks may stand around a quantity and before its unit") {
    for (const char* text : {"50 nm", "  50nm", "50nm   ", " 50  nm "}) CHECK(parse_quantity(text, Dimension::length) == 5e-8);
    CHECK(parse_quantity(" 3 ", Dimension::none) == 3.0);
}

TEST_CASE("a missing unit is refused, with the units that are known") {
    for (const char* text : {"50", "50 ", "0", "-1", "1e-3"})
        CHECK(refusal(text, Dimension::length) == "'" + std::string(text) + "' has no unit; known here: m, cm, mm, um, nm");
}

TEST_CASE("a unit of another kind or another case is refused") {
    const std::string wrong = " has no unit of the right kind; known here: ";
    CHECK(refusal("50s", Dimension::length) == "'50s'" + wrong + "m, cm, mm, um, nm");
    CHECK(refusal("3mPa", Dimension::pressure) == "'3mPa'" + wrong + "Pa, kPa, MPa, GPa, N/mm2, kN/mm2");
    CHECK(refusal("3mpa", Dimension::pressure) == "'3mpa'" + wrong + "Pa, kPa, MPa, GPa, N/mm2, kN/mm2");
    CHECK(refusal("50NM", Dimension::length) == "'50NM'" + wrong + "m, cm, mm, um, nm");
    CHECK(refusal("300k", Dimension::temperature) == "'300k'" + wrong + "K, C");
    CHECK(refusal("300c", Dimension::temperature) == "'300c'" + wrong + "K, C");
    CHECK(refusal("1H", Dimension::time) == "'1H'" + wrong + "s, ms, us, min, h, d");
    CHECK(refusal("5nmx", Dimension::length) == "'5nmx'" + wrong + "m, cm, mm, um, nm");
    CHECK(refusal("5nm 6nm", Dimension::length) == "'5nm 6nm'" + wrong + "m, cm, mm, um, nm");
    CHECK(refusal("0x10m", Dimension::length) == "'0x10m'" + wrong + "m, cm, mm, um, nm");
    CHECK(refusal("1,5nm", Dimension::length) == "'1,5nm'" + wrong + "m, cm, mm, um, nm");
    CHECK(refusal("5\tnm", Dimension::length) == "'5\tnm'" + wrong + "m, cm, mm, um, nm");
    CHECK(refusal("5nm", Dimension::none) == "'5nm' has a unit where a plain number is required");
    CHECK(refusal("0x10", Dimension::none) == "'0x10' has a unit where a plain number is required");
}

TEST_CASE("what is no finite number is refused") {
    for (const char* text : {"", " ", "nm", "nan", "nanm", "inf", "infm", "-infm", "nm5", "+5nm", "--5nm", ".", "e5m"})
        CHECK(refusal(text, Dimension::length) == "'" + std::string(text) + "' is not a number");
    for (const char* text : {"1e999m", "-1e999m"})
        CHECK(refusal(text, Dimension::length) == "'" + std::string(text) + "' is out of the range of numbers");
    CHECK(refusal("1e308GPa", Dimension::pressure) == "'1e308GPa' is out of the range of numbers");
}

TEST_CASE("no temperature is at absolute zero or below") {
    for (const char* text : {"0K", "-1K", "-273.15C", "-300C"})
        CHECK(refusal(text, Dimension::temperature) == "'" + std::string(text) + "' is not above absolute zero");
}

}  // namespace
