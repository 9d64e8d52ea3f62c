// green_options.cpp: names, defaults, help and checks of the options of `sinter green`.
#include "tools/sinter/green_options.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <limits>

#include "tools/common/quantity_options.h"

namespace kiln::sinter {

using packing::DiameterList, packing::Method;

namespace {

// The densest packing of equal spheres fills pi/sqrt(18) = 0.7405.
constexpr double densest_loose = 0.74;

[[noreturn]] void refuse(const std::string& sentence) { throw CLI::ValidationError(sentence); }

Method parse_method(const std::string& text) {
    if (text == "loose") return Method::loose;
    if (text == "affine") return Method::affine;
    if (text == "soft") return Method::soft;
    refuse("--method: '" + text + "' is none of loose, affine, soft");
}

std::array<double, 3> parse_aspect(const std::string& text) {
    std::array<double, 3> aspect;
    std::size_t at = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t colon = axis < 2 ? text.find(':', at) : text.size();
        if (colon == std::string::npos) refuse("--aspect: '" + text + "' is not three numbers such as 4:1:1");
        aspect[axis] =
            cli::parsed("--aspect", [&] { return io::parse_quantity(text.substr(at, colon - at), io::Dimension::none); });
        if (!(aspect[axis] > 0.0)) refuse("--aspect: '" + text + "' has an edge that is not above zero");
        at = colon + 1;
    }
    return aspect;
}

}  // namespace

void GreenOptions::add_to(CLI::App& app) {
    using cli::add_quantity, io::Dimension;
    common.add_to(app, false);
    app.add_option("-n,--particles", packing.particles, "Number of particles; with file:LIST as many as it has lines")
        ->capture_default_str()
        ->type_name("N");
    add_quantity(app, "--diameter", diameter, Dimension::length, "Diameter of monosize particles", "100nm");
    app.add_option(
           "--distribution", distribution,
           "Diameters by number: monosize; lognormal:MEDIAN:DEVIATION[:MIN:MAX] with the geometric standard deviation, as in "
           "lognormal:100nm:1.4:50nm:200nm; bimodal:D1:D2:FRACTION with the number fraction of D1; file:LIST, one diameter with "
           "its unit a line, taken in turn")
        ->capture_default_str()
        ->type_name("SIZES");
    add_quantity(app, "--density", packing.density, Dimension::none, "Relative density: volume of the spheres over that of the box",
                 "0.43");
    app.add_option_function<std::string>(
           "--method", [this](const std::string& text) { packing.method = parse_method(text); },
           "loose: random spheres pushed apart until none overlap, then shrunk together by --swell; affine: "
           "the same, compacted to --compact-to; soft: pushed apart down to --mean-overlap")
        ->default_str("loose")
        ->type_name("METHOD");
    app.add_option_function<std::string>(
           "--compact-to",
           [this](const std::string& text) {
               packing.compact_to = cli::parsed("--compact-to", [&] { return io::parse_quantity(text, Dimension::none); });
           },
           "Relative density to shrink all distances between centres to in the end, radii unchanged")
        ->type_name("NUMBER");
    add_quantity(app, "--swell", packing.swell, Dimension::none,
                 "Share of distances by which touching spheres are pressed into contact", "0.01");
    add_quantity(app, "--damping", packing.damping, Dimension::none,
                 "Drag on spheres pushed apart, over the critical damping of a pair; more of it leaves more contacts", "0.295");
    add_quantity(app, "--mean-overlap", packing.mean_overlap, Dimension::none,
                 "Mean overlap over diameter at which method soft ends", "0.02");
    app.add_option_function<std::string>(
           "--aspect", [this](const std::string& text) { packing.aspect = parse_aspect(text); },
           "Edges of the periodic box against each other, such as 4:1:1")
        ->default_str("1:1:1")
        ->type_name("X:Y:Z");
    app.add_option("--material", material, "Built-in material, or a file NAME.json that holds one")
        ->capture_default_str()
        ->type_name("NAME");
    app.add_option("--seed", packing.seed, "Seed of the random numbers")->capture_default_str()->type_name("N");
}

void GreenOptions::complete(const CLI::App& app) {
    const bool soft = packing.method == Method::soft;
    if (!(packing.density > 0.0 && packing.density < (soft ? 1.0 : densest_loose)))
        refuse(soft ? "--density: a relative density lies between 0 and 1"
                    : "--density: spheres that do not overlap have a relative density between 0 and 0.74");
    if (packing.method == Method::affine && !packing.compact_to) refuse("--method affine needs --compact-to");
    if (packing.compact_to && !(*packing.compact_to >= packing.density && *packing.compact_to < 1.0))
        refuse("--compact-to: the relative density is not between --density and 1");
    if (!(packing.swell >= 0.0 && packing.swell <= 0.2)) refuse("--swell: the share is not between 0 and 0.2");
    if (!(packing.damping >= 0.1 && packing.damping <= 10.0)) refuse("--damping: the ratio is not between 0.1 and 10");
    if (!(packing.mean_overlap > 0.0 && packing.mean_overlap < 0.5)) refuse("--mean-overlap: the ratio is not between 0 and 0.5");
    if (soft ? app.count("--swell") > 0 : app.count("--mean-overlap") > 0)
        refuse(soft ? "--swell does not go with --method soft" : "--mean-overlap goes with --method soft only");
    if (!(diameter > 0.0)) refuse("--diameter: the diameter is not above zero");
    if (distribution != "monosize" && app.count("--diameter") > 0) refuse("--diameter goes with --distribution monosize only");
    packing.distribution = cli::parsed("--distribution", [this] { return packing::parse_distribution(distribution, diameter); });
    if (const auto* list = std::get_if<DiameterList>(&packing.distribution); list && app.count("--particles") == 0)
        packing.particles = static_cast<std::int64_t>(list->diameters.size());
    if (packing.particles < 1 || packing.particles > std::numeric_limits<std::int32_t>::max())
        refuse("--particles: " + std::to_string(packing.particles) + " is not between 1 and 2147483647");
}

}  // namespace kiln::sinter
