// options.cpp: the options of bend, their help and what must not be combined.
#include "tools/bend/options.h"

#include <CLI/CLI.hpp>
#include <utility>

#include "tools/common/bond_model.h"
#include "tools/common/quantity_options.h"
#include "tools/common/value_options.h"

namespace kiln::bend {

using bending::Method;

namespace {

constexpr double finest_with_friction = 1e-12;

constexpr const char* description =
    "Bends a bar of bonded particles on two supports under a punch.\n\n"
    "Three rigid cylinders along y, the bar along x, the load along -z. The bar is cut from the periodic box: bonds through the "
    "opened faces are dropped. Writes one dem-bend document a state, with the curve of deflection (m, lower face under the load "
    "against the bar above its supports), travel of the punch (m) and force (N) over all cycles.";

constexpr const char* footer =
    "Static: bonds are springs; particles touch the cylinders, and each other where a gap between them closes, by Hertz's law, "
    "and part freely.\n"
    "Dynamic: the same by leapfrog steps. Of the work of the punch it says what was stored and what was dissipated.\n"
    "Both: with --friction contacts are also tangential springs (Mindlin) that slip (Coulomb). The bar then stores less than the "
    "work of the punch, unloading does not retrace loading, and the supports press the bar together (horizontal_reaction, N).\n\n"
    "Keys of a result:\n"
    "  material, young_modulus (Pa), poisson_ratio\n"
    "                        of the solid that most particles are made of; material names all\n"
    "  poisson_ratio_source  what it is from\n"
    "  relative_density      of the state that the bar is cut from\n"
    "  length, width, height, span, punch_radius (m)\n"
    "  effective_span        m, that makes up for contacts which are not above the cylinders' axes\n"
    "  slenderness           span over height, L/h\n"
    "  bond_law, bond_shear, method, friction\n"
    "  particles, bonds      of the bar\n"
    "  dropped_bonds, negligible_bonds  through opened faces; too thin to count\n"
    "  fragments, fragment_particles, rattlers\n"
    "                        pieces beside the bar, their particles; single particles\n"
    "  curve                 {deflection (m), punch (m), force (N)} of all cycles\n"
    "  contacts, closed_gaps  that carry force under the maximum force; pairs without a bond among them\n"
    "  roll                  rad, by which the bar turned to rest on its supports\n"
    "  horizontal_reaction   N, of friction at the supports\n"
    "  energy                J: {bonds, contacts} stored under the maximum force; {friction} spent;\n"
    "                        {error}: what is missing of the work, over what was stored\n"
    "  iterations, residual  static: of the linear solver; largest unbalanced force over contact force\n"
    "  converged, warnings   sentences, which results made of this one keep\n"
    "of a test to failure\n"
    "  strength              {bending_strength (Pa; 3 F L/(2 b h^2) of the maximum force), peak_force\n"
    "                        (N), first_break (Pa; the same at the first break), breaks,\n"
    "                        tensile_strength (Pa), shear_strength (Pa), until, calibrated_to (Pa; of\n"
    "                        --calibrate-to, which then found tensile_strength), tests (it took)}\n"
    "  energy                also {work, dissipated}\n"
    "of the dynamic method\n"
    "  time_step (s), steps, punch_velocity (m/s), damping, mass_scaling\n"
    "  energy                also {work, stored_at_end, kinetic_at_end, damping}\n\n"
    "Examples:\n"
    "  bondify sintered.kiln | bend | analyze modulus\n"
    "  bondify --method necks sintered.kiln | bend | analyze modulus --table\n"
    "  bend --max-deflection 0.5nm --states bent.kiln -o bent.json bonded.kiln\n"
    "  bend --tensile-strength 500MPa bonded.kiln | jq .strength.bending_strength\n"
    "  bend --calibrate-to 120MPa bonded.kiln | jq .strength.tensile_strength\n"
    "  for law in series neck centre; do bend --bond-law $law bonded.kiln; done |\n"
    "      analyze modulus --table";

}  // namespace

void Options::add_to(CLI::App& app) {
    using io::Dimension;
    app.description(description);
    app.footer(footer);
    cli::add_quantity(app, "--span", span, Dimension::length, "Distance between the supports", "0.8 of the bar's length");
    app.add_flag("--allow-block", allow_block,
                 "Also bend what is no bar: a span L below twice the height h, for which the formulas of beams do not hold. Below "
                 "L/h = 4 there is a warning, which the result keeps");
    cli::add_quantity(app, "--punch-radius", punch_radius, Dimension::length, "Radius of the three cylinders",
                      "0.75 of the bar's height");
    auto* deflection = cli::add_quantity(app, "--max-deflection", max_deflection, Dimension::length,
                                         "Deflection at which unloading begins", "0.001 of the bar's height");
    cli::add_quantity(app, "--max-force", max_force, Dimension::force, "Force at which unloading begins")->excludes(deflection);
    cli::add_number(app, "--cycles", cycles, {1, 1000}, "How often the bar is loaded and unloaded");
    cli::add_number(app, "--points", points, {3, 1000}, "Points of the curve in each branch, at equal steps of force");
    cli::add_number(app, "--friction", friction, {0.0, 10.0},
                    "Coefficient of friction of all contacts: the cylinders are fixed against turning, and the bar slides on them "
                    "where the tangential force reaches this fraction of the normal one; 0: rollers");
    cli::add_bond_model(app, model);
    cli::add_number(app, "--tolerance", tolerance, {1e-14, 1e-2},
                    "Unbalanced force over contact force at which an equilibrium is reached; static");
    solver.add_to(app);
    app.add_option("--states", states, "Also write the bar bent by the maximum force, with the forces in its bonds, to this file")
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
                                                         {"--shear-strength", shear_strength},
                                                         {"--calibrate-to", calibrate_to}};
    for (const auto& [name, value] : quantities) {
        if (app.count(name) > 0 && !(value > 0.0)) throw CLI::ValidationError(name, "must be greater than zero");
    }
    for (const char* name : {"--punch-velocity", "--damping", "--mass-scaling"}) {
        if (app.count(name) > 0 && method != Method::motion) throw CLI::ValidationError(name, "needs --method dynamic");
    }
    if (app.count("--tolerance") > 0 && method == Method::motion) {
        throw CLI::ValidationError("--tolerance", "has no meaning with --method dynamic");
    }
    if (app.count("--solver") > 0 && method == Method::motion) {
        throw CLI::ValidationError("--solver", "has no meaning with --method dynamic, which solves no systems");
    }
    if (app.count("--until") > 0 && !to_failure()) {
        throw CLI::ValidationError("--until", "needs --tensile-strength, --shear-strength or --calibrate-to");
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
    auto* tensile = cli::add_quantity(app, "--tensile-strength", tensile_strength, io::Dimension::pressure,
                      "Bonds break where tension and bending together reach this stress; the bar is loaded until it fails", "none");
    auto* shear = cli::add_quantity(app, "--shear-strength", shear_strength, io::Dimension::pressure,
                                    "The same for shear and torsion together", "none");
    cli::add_quantity(
        app, "--calibrate-to", calibrate_to, io::Dimension::pressure,
        "Bending strength that such a bar was measured to have: the tensile strength of the bonds with which this one "
        "breaks there is found by several tests to failure, and used",
        "none")
        ->excludes(tensile)
        ->excludes(shear);
    cli::add_number(app, "--until", until, {0.01, 0.999},
                    "Fraction of its maximum to which the force has fallen when a test to failure ends");
}

void Options::add_dynamic(CLI::App& app) {
    cli::add_choice(app, "--method", method, {{"static", Method::equilibria}, {"dynamic", Method::motion}},
                    "static: a sequence of equilibria; dynamic: the motion of all particles in time, as a reference, which takes "
                    "hundreds of times as long");
    cli::add_quantity(app, "--punch-velocity", punch_velocity, io::Dimension::velocity, "Speed of the punch; dynamic",
                      "such that the maximum deflection is reached in 20 of the bar's own periods");
    cli::add_number(app, "--damping", damping, {0.0, 0.99}, "Fraction of the unbalanced force that brakes each particle; dynamic");
    cli::add_number(app, "--mass-scaling", mass_scaling, {cli::above_zero},
                    "Factor on the mass of the particles; time steps and periods grow with its square root; dynamic");
}

}  // namespace kiln::bend
