// green_options.cpp: names, defaults, help and checks of the options of `sinter green`.
#include "tools/sinter/green_options.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <limits>
#include <sstream>

#include "tools/common/quantity_options.h"
#include "tools/common/value_options.h"

namespace kiln::sinter {

using packing::DiameterList, packing::Method, packing::Shares, packing::Weighting;

namespace {

// The densest packing of equal spheres fills pi/sqrt(18) = 0.7405.
constexpr double densest_loose = 0.74;

constexpr const char* green_description =
    "Makes a green body: random spheres in a periodic box at a relative density.";

constexpr const char* green_footer =
    "Keys of the summary in the state's history:\n"
    "  method, seed            loose, affine, soft, or spheres of a list\n"
    "  relative_density, coordination_number\n"
    "  mean_overlap_ratio      h/2R, or h/(r1 + r2) of unequal spheres\n"
    "  diameters               {asked, made} of {by_number, by_volume} {d10, d50, d90}, m; made also has\n"
    "                          {mean, minimum, maximum}\n"
    "of a list of spheres\n"
    "  contacts, largest_overlap_ratio\n"
    "  measure                 volume that the density refers to, as analyze density has it\n\n"
    "Examples:\n"
    "  sinter green -n 3000 --density 0.43 --aspect 6:1:1 --seed 1 -o green.kiln\n"
    "  sinter green -n 99000 | sinter --temperature 1200C --to-density 0.67 -o sintered.kiln\n"
    "  sinter green -n 6000 --distribution percentiles:80nm:120nm:200nm |\n"
    "      analyze density | jq .diameter.by_volume\n"
    "  sinter green --spheres tomography.csv --box 10um:10um:10um --periodic xyz -o green.kiln\n"
    "  sinter green -n 6000 --distribution lognormal:100nm:1.4:50nm:200nm --compact-to 0.55 |\n"
    "      analyze density --bins 10 | jq .diameter_histogram";

[[noreturn]] void refuse(const std::string& sentence) { throw CLI::ValidationError(sentence); }

/// Three quantities such as 4:1:1.
std::array<double, 3> parse_three(const std::string& option, const std::string& text, io::Dimension dimension,
                                  const std::string& example) {
    std::array<double, 3> three;
    std::size_t at = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t colon = axis < 2 ? text.find(':', at) : text.size();
        if (colon == std::string::npos) refuse(option + ": '" + text + "' is not three numbers such as " + example);
        three[axis] = cli::parsed(option, [&] { return io::parse_quantity(text.substr(at, colon - at), dimension); });
        at = colon + 1;
    }
    return three;
}

/// The same above zero.
std::array<double, 3> parse_edges(const std::string& option, const std::string& text, io::Dimension dimension,
                                  const std::string& example) {
    const std::array<double, 3> edges = parse_three(option, text, dimension, example);
    for (const double edge : edges)
        if (!(edge > 0.0)) refuse(option + ": '" + text + "' has an edge that is not above zero");
    return edges;
}

Vec3 vector_of(const std::array<double, 3>& three) { return {three[0], three[1], three[2]}; }

}  // namespace

void GreenOptions::add_to(CLI::App& app) {
    using cli::add_quantity, io::Dimension;
    app.description(green_description);
    app.footer(green_footer);
    cli::add_number(app, "-n,--particles", packing.particles, {1, std::numeric_limits<std::int32_t>::max()},
                    "Number of particles; of a list of diameters as many as it has lines");
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
           "--aspect",
           [this](const std::string& text) { packing.aspect = parse_edges("--aspect", text, Dimension::none, "4:1:1"); },
           "Edges of the periodic box against each other, such as 4:1:1")
        ->default_str("1:1:1")
        ->type_name("X:Y:Z");
    add_spheres(app);
    app.add_option("--material", material, "Built-in material (analyze materials lists them), or a file NAME.json that holds one")
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
           "lognormal on either side of D50; file:FILE, a list of diameters, each with its unit, that are drawn at random, or a "
           "table of diameters and shares as sieves and laser diffraction export them")
        ->capture_default_str()
        ->type_name("SIZES");
    cli::add_choice(app, "--sizes-by", sizes_by,
                    {{"number", Weighting::number}, {"volume", Weighting::volume}, {"mass", Weighting::volume}},
                    "What the distribution counts: the number of particles, or their volume or mass; particles are drawn so that "
                    "their number follows from it")
        ->default_str("number; volume of percentiles; as the file says");
    cli::add_choice(app, "--shares", shares,
                    {{"class", Shares::classes}, {"undersize", Shares::undersize}, {"oversize", Shares::oversize}},
                    "What a share in file:FILE is of: the class with this diameter, all that is smaller, all that is larger")
        ->default_str("as the file says");
    app.add_option_function<std::string>(
           "--columns",
           [this](const std::string& text) {
               std::istringstream names(text);
               for (std::string name; std::getline(names, name, ',');) manner.columns.push_back(name);
           },
           "Names for the columns of FILE in their order, such as size,-,share or x,y,z,d, - for one that is not read")
        ->type_name("NAME,...")
        ->default_str("the headings of FILE");
    app.add_option("--length-unit", manner.unit, "Unit of lengths in FILE where no heading states one [" +
                   io::known_units(io::Dimension::length) + "]")
        ->type_name("UNIT");
}

void GreenOptions::add_spheres(CLI::App& app) {
    app.add_option("--spheres", spheres,
                   "Table of spheres x, y, z, radius or diameter, of a tomograph or another program, to be the body as they are")
        ->type_name("FILE");
    app.add_option_function<std::string>(
           "--box",
           [this](const std::string& text) {
               body.lengths = vector_of(parse_edges("--box", text, io::Dimension::length, "10um:10um:10um"));
           },
           "Edges of the box of --spheres")
        ->type_name("X:Y:Z")
        ->default_str("as far as the spheres reach");
    app.add_option_function<std::string>(
           "--origin",
           [this](const std::string& text) {
               body.origin = vector_of(parse_three("--origin", text, io::Dimension::length, "0um:0um:-5um"));
           },
           "Lowest corner of --box")
        ->type_name("X:Y:Z")
        ->default_str("0m:0m:0m");
    app.add_option_function<std::string>(
           "--periodic",
           [this](const std::string& text) {
               if (text.empty()) refuse("--periodic: '' is not made of the axes x, y and z");
               body.periodic = cli::axes_from("--periodic", text);
           },
           "Axes along which --box is periodic, such as xyz; the body is free along the others")
        ->type_name("AXES")
        ->default_str("none");
}

void GreenOptions::complete(const CLI::App& app) {
    if (!manner.unit.empty() && !io::scale_of(manner.unit, io::Dimension::length))
        refuse("--length-unit: '" + manner.unit + "' is none of " + io::known_units(io::Dimension::length));
    if (!spheres.empty()) return complete_spheres(app);
    for (const char* name : {"--box", "--origin", "--periodic"})
        if (app.count(name) > 0) refuse(std::string(name) + " goes with --spheres");
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
    complete_sizes(app);
}

void GreenOptions::complete_spheres(const CLI::App& app) {
    for (const char* name : {"--particles", "--diameter", "--distribution", "--sizes-by", "--shares", "--density", "--method",
                             "--compact-to", "--damping", "--mean-overlap", "--aspect", "--seed"})
        if (app.count(name) > 0) refuse(std::string(name) + " does not go with --spheres, which are taken as they are");
    if (body.origin && !body.lengths) refuse("--origin requires --box");
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (body.periodic[axis] && !body.lengths)
            refuse("--periodic requires --box: how far the box reaches is not in the spheres");
    if (app.count("--swell") > 0) body.swell = packing.swell;
}

void GreenOptions::complete_sizes(const CLI::App& app) {
    const bool file = distribution.starts_with("file:");
    for (const char* name : {"--shares", "--columns", "--length-unit"})
        if (!file && app.count(name) > 0)
            refuse(std::string(name) + " goes with --distribution file:FILE" + (name[2] == 's' ? "" : " or --spheres"));
    if (!(diameter > 0.0)) refuse("--diameter: the diameter is not above zero");
    if (distribution != "monosize" && app.count("--diameter") > 0) refuse("--diameter goes with --distribution monosize only");
    if (distribution == "monosize" && sizes_by) refuse("--sizes-by: all sizes of --distribution monosize are one");
    packing.distribution = cli::parsed(
        "--distribution", [this] { return packing::parse_distribution(distribution, diameter, sizes_by, shares, manner); });
    if (const auto* list = std::get_if<DiameterList>(&packing.distribution); list && app.count("--particles") == 0)
        packing.particles = static_cast<std::int64_t>(list->diameters.size());
    if (packing.particles < 1 || packing.particles > std::numeric_limits<std::int32_t>::max())
        refuse("--particles: " + std::to_string(packing.particles) + " is not between 1 and 2147483647");
}

}  // namespace kiln::sinter
