// options.cpp: the options of bend, their help and what must not be combined.
#include "tools/bend/options.h"

#include <CLI/CLI.hpp>
#include <utility>

#include "tools/common/bond_model.h"
#include "tools/common/quantity_options.h"

namespace kiln::bend {

using bending::Method;

namespace {

constexpr double finest_with_friction = 1e-12;

constexpr const char* description =
    "Bends a bar of bonded particles on two supports under a punch: three rigid cylinders along y, the bar along x, the load along "
    "-z. The bar is cut from the periodic box: bonds through the opened faces are dropped. Writes one dem-bend document a state, "
    "with "
    "the curve of deflection (m, lower face under the load against the bar above its supports), punch travel (m) and force (N) "
    "over "
    "all cycles.";

constexpr const char* footer =
    "Static: bonds are springs; particles touch the cylinders, and each other where a gap between them closes, by Hertz's law, and "
    "part\n"
    "freely.\n"
    "Dynamic: the same by leapfrog steps. Of the work of the punch it says what was stored and what was dissipated.\n"
    "Both: with --friction contacts are also tangential springs (Mindlin) that slip (Coulomb). The bar then stores less than the "
    "punch\n"
    "works, unloading does not retrace loading, and the supports thrust it together (horizontal_reaction, N).\n"
    "Examples:\n"
    "  bondify sintered.kiln | bend | analyze modulus\n"
    "  bend --span 8um --punch-radius 2um --max-force 60uN --states bent.kiln bonded.kiln -o bend.json\n"
    "  for law in series neck centre; do bend --bond-law $law bonded.kiln; done | analyze modulus --table";

}  // namespace

void Options::add_to(CLI::App& app) {
    using io::Dimension;
    app.description(description);
    app.footer(footer);
    cli::add_quantity(app, "--span", span, Dimension::length, "distance between the supports", "0.8 of the bar's length");
    cli::add_quantity(app, "--punch-radius", punch_radius, Dimension::length, "radius of the three cylinders",
                      "0.75 of the bar's height");
    auto* deflection = cli::add_quantity(app, "--max-deflection", max_deflection, Dimension::length,
                                         "deflection at which unloading begins", "0.001 of the bar's height");
    cli::add_quantity(app, "--max-force", max_force, Dimension::force, "force at which unloading begins, instead")
        ->excludes(deflection);
    app.add_option("--cycles", cycles, "times that the bar is loaded and unloaded")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    app.add_option("--points", points, "points of the curve in each branch, at equal steps of force")
        ->check(CLI::Range(3, 1000))
        ->capture_default_str();
    app.add_option(
           "--friction", friction,
           "coefficient of friction of all contacts (plain number): the cylinders are fixed against turning, and the bar slides "
           "on them where the tangential force reaches this share of the normal one; 0: rollers")
        ->check(CLI::Range(0.0, 10.0))
        ->capture_default_str();
    cli::add_bond_model(app, model);
    app.add_option("--tolerance", tolerance,
                   "unbalanced force over contact force at which an equilibrium is reached (plain number)")
        ->check(CLI::Range(1e-14, 1e-2))
        ->default_str("1e-6");
    app.add_option("--states", states, "also write the bar bent by the greatest force, with the forces in its bonds, to this file")
        ->type_name("FILE");
    add_dynamic(app);
    add_strength(app);
    app.callback([this, &app] { check(app); });
}

void Options::check(const CLI::App& app) const {
    const std::pair<const char*, double> quantities[] = {{"--span", span},
                                                         {"--punch-radius", punch_radius},
                                                         {"--max-deflection", max_deflection},
                                                         {"--max-force", max_force},
                                                         {"--punch-velocity", punch_velocity},
                                                         {"--tensile-strength", tensile_strength},
                                                         {"--shear-strength", shear_strength}};
    for (const auto& [name, value] : quantities) {
        if (app.count(name) > 0 && !(value > 0.0)) throw CLI::ValidationError(name, "must be greater than zero");
    }
    for (const char* name : {"--punch-velocity", "--damping", "--mass-scaling"}) {
        if (app.count(name) > 0 && method != Method::motion) throw CLI::ValidationError(name, "needs --method dynamic");
    }
    if (app.count("--until") > 0 && !to_failure()) {
        throw CLI::ValidationError("--until", "needs --tensile-strength or --shear-strength");
    }
    if (friction > 0.0 && tolerance < finest_with_friction) {
        throw CLI::ValidationError("--tolerance", "must be at least 1e-12 with --friction, whose limits are known no better");
    }
    if (!to_failure()) return;
    if (method != Method::equilibria) throw CLI::ValidationError("--method", "must be static for bonds to break");
    for (const char* name : {"--max-deflection", "--max-force", "--cycles", "--points"}) {
        if (app.count(name) > 0) throw CLI::ValidationError(name, "has no meaning in a test to failure");
    }
    if (friction > 0.0) throw CLI::ValidationError("--friction", "must be 0 in a test to failure: its cylinders are rollers");
}

void Options::add_strength(CLI::App& app) {
    cli::add_quantity(app, "--tensile-strength", tensile_strength, io::Dimension::pressure,
                      "bonds break where tension and bending together reach this stress; the bar is loaded until it fails", "none");
    cli::add_quantity(app, "--shear-strength", shear_strength, io::Dimension::pressure, "the same for shear and torsion together",
                      "none");
    app.add_option("--until", until,
                   "the test to failure ends where the force has fallen to this share of its greatest (plain number)")
        ->check(CLI::Range(0.01, 0.999))
        ->capture_default_str();
}

void Options::add_dynamic(CLI::App& app) {
    app.add_option_function<std::string>(
           "--method", [this](const std::string& text) { method = text == "dynamic" ? Method::motion : Method::equilibria; },
           "static, a sequence of equilibria; dynamic, the motion of all particles in time, for reference: thousands of times the "
           "work")
        ->check(CLI::IsMember({"static", "dynamic"}))
        ->default_str("static");
    cli::add_quantity(app, "--punch-velocity", punch_velocity, io::Dimension::velocity, "speed of the punch, dynamic",
                      "the greatest deflection in 20 of the bar's own periods");
    app.add_option("--damping", damping, "share of the unbalanced force that brakes each particle, dynamic (plain number below 1)")
        ->check(CLI::Range(0.0, 0.99))
        ->capture_default_str();
    app.add_option("--mass-scaling", mass_scaling,
                   "factor on the mass of the particles, dynamic (plain number); time steps and periods grow with its square root")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
}

}  // namespace kiln::bend
