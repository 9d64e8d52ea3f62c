// green_options.cpp: names, defaults, help and checks of the options of `sinter green`.
#include "tools/sinter/green_options.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <limits>

#include "tools/common/quantity_options.h"
#include "tools/common/value_options.h"

namespace kiln::sinter {

using packing::DiameterList, packing::Method, packing::Weighting;

namespace {

// The densest packing of equal spheres fills pi/sqrt(18) = 0.7405.
constexpr double densest_loose = 0.74;

constexpr const char* green_description =
    "Makes a green body: random spheres in a periodic box at a relative density.";

constexpr const char* green_footer =
    "Examples:\n"
    "  sinter green -n 3000 --density 0.43 --aspect 4:1:1 --seed 1 -o green.kiln\n"
    "  sinter green -n 99000 | sinter --temperature 1200C --to-density 0.67 -o sintered.kiln\n"
    "  sinter green -n 6000 --distribution lognormal:100nm:1.4:50nm:200nm --compact-to 0.55 |\n"
    "      analyze density --bins 10 | jq .diameter_histogram";

[[noreturn]] void refuse(const std::string& sentence) { throw CLI::ValidationError(sentence); }

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
    app.description(green_description);
    app.footer(green_footer);
    cli::add_number(app, "-n,--particles", packing.particles, {1, std::numeric_limits<std::int32_t>::max()},
                    "Number of particles; with file:LIST as many as it has lines");
    add_quantity(app, "--diameter", diameter, Dimension::length, "Diameter of monosize particles", "100nm");
    add_sizes(app);
    cli::add_number(app, "--density", packing.density, {}, "Relative density: volume of the spheres over that of the box");
    cli::add_choice(app, "--method", packing.method,
                    {{"loose", Method::loose}, {"affine", Method::affine}, {"soft", Method::soft}},
                    "loose: random spheres pushed apart until none overlap, then brought together by --swell; affine: the same, "
                    "compacted to --compact-to; soft: pushed apart down to --mean-overlap");
    app.add_option_function<std::string>(
           "--compact-to",
           [this](const std::string& text) { packing.compact_to = cli::number_from<double>("--compact-to", text, {}); },
           "Relative density to which all distances between centres are scaled down in the end, radii unchanged; chooses --method "
           "affine where no method is given")
        ->type_name("NUMBER");
    cli::add_number(app, "--swell", packing.swell, {0.0, 0.2},
                    "Fraction of their distance by which touching spheres are pressed into contact");
    cli::add_number(app, "--damping", packing.damping, {0.1, 10.0},
                    "Drag on spheres pushed apart, over the critical damping of a pair; more of it leaves more contacts");
    cli::add_number(app, "--mean-overlap", packing.mean_overlap, {cli::above_zero, 0.5},
                    "Mean overlap over diameter at which method soft ends");
    app.add_option_function<std::string>(
           "--aspect", [this](const std::string& text) { packing.aspect = parse_aspect(text); },
           "Edges of the periodic box against each other, such as 4:1:1")
        ->default_str("1:1:1")
        ->type_name("X:Y:Z");
    app.add_option("--material", material, "Built-in material, or a file NAME.json that holds one")
        ->capture_default_str()
        ->type_name("NAME");
    cli::add_number(app, "--seed", packing.seed, {}, "Seed of the random numbers");
    common.add_to(app, false);
}

void GreenOptions::add_sizes(CLI::App& app) {
    app.add_option(
           "--distribution", distribution,
           "Diameters. monosize: all alike; lognormal:MEDIAN:DEVIATION[:MIN:MAX] with the geometric standard deviation, as in "
           "lognormal:100nm:1.4:50nm:200nm; bimodal:D1:D2:FRACTION with the fraction of D1; percentiles:D10:D50:D90[:MIN:MAX], "
           "lognormal on either side of D50; file:LIST, one diameter with its unit a line, drawn at random")
        ->capture_default_str()
        ->type_name("SIZES");
    cli::add_choice(app, "--sizes-by", sizes_by,
                    {{"number", Weighting::number}, {"volume", Weighting::volume}, {"mass", Weighting::volume}},
                    "What the distribution counts: the number of particles, or their volume or mass; particles are drawn so that "
                    "their number follows from it")
        ->default_str("number; volume of percentiles");
}

void GreenOptions::complete(const CLI::App& app) {
    const bool soft = packing.method == Method::soft;
    if (packing.compact_to && app.count("--method") == 0) packing.method = Method::affine;
    if (packing.compact_to && packing.method == Method::loose) refuse("--compact-to goes with --method affine or soft");
    if (!(packing.density > 0.0 && packing.density < (soft ? 1.0 : densest_loose)))
        refuse(soft ? "--density: a relative density lies between 0 and 1"
                    : "--density: spheres that do not overlap have a relative density between 0 and 0.74");
    if (packing.method == Method::affine && !packing.compact_to) refuse("--method affine requires --compact-to");
    if (packing.compact_to && !(*packing.compact_to >= packing.density && *packing.compact_to < 1.0))
        refuse("--compact-to: the relative density is not between --density and 1");
    if (soft ? app.count("--swell") > 0 : app.count("--mean-overlap") > 0)
        refuse(soft ? "--swell does not go with --method soft" : "--mean-overlap goes with --method soft only");
    if (!(diameter > 0.0)) refuse("--diameter: the diameter is not above zero");
    if (distribution != "monosize" && app.count("--diameter") > 0) refuse("--diameter goes with --distribution monosize only");
    if (distribution == "monosize" && sizes_by) refuse("--sizes-by: all sizes of --distribution monosize are one");
    packing.distribution =
        cli::parsed("--distribution", [this] { return packing::parse_distribution(distribution, diameter, sizes_by); });
    if (sizes_by && std::holds_alternative<DiameterList>(packing.distribution))
        refuse("--sizes-by: a list of diameters has one of each particle");
    if (const auto* list = std::get_if<DiameterList>(&packing.distribution); list && app.count("--particles") == 0)
        packing.particles = static_cast<std::int64_t>(list->diameters.size());
    if (packing.particles < 1 || packing.particles > std::numeric_limits<std::int32_t>::max())
        refuse("--particles: " + std::to_string(packing.particles) + " is not between 1 and 2147483647");
}

}  // namespace kiln::sinter
