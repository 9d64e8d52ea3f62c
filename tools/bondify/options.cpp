// options.cpp: the options of bondify, their help and what must not be combined.
#include "tools/bondify/options.h"

#include <CLI/CLI.hpp>

#include "tools/common/quantity_options.h"
#include "tools/common/value_options.h"

namespace kiln::bondify {

namespace {

using bonding::Method, bonding::Necks, bonding::Sharing;

constexpr const char* description =
    "Turns overlapping particles into particles that solid bonds join.\n\n"
    "exact, sweep: particles shrink until none overlap, and where two did there is a cylindrical bond of what they lost (Dosta et "
    "al. 2017, Eq. 2-4).\n"
    "necks: particles keep their radii, and every contact gets the neck that the sintering law gives it, a = sqrt(4 R* h) (Coble), "
    "times one factor: that with which the union of particles and necks fills what the mass fills.\n"
    "Every state is written back with the arrays bonds.pair, image, radius (m), length (m) and volume (m3), the solid that a bond "
    "adds to that of the particles: what they lost, none for necks.";

constexpr const char* footer =
    "A bond whose volume does not fit between its particles gets the radius of the smaller one; a particle stops shrinking at 1 % "
    "of its radius. Both are counted in the state's history and in a warning.\n"
    "Of necks the history tells neck_factor, solid_fraction (of the box, by mass), union_fraction (of the box, particles and "
    "necks) with its standard error union_error, and how many are limited: no neck is thicker than sin(psi/2) times its smaller "
    "particle, with the material's dihedral angle psi, or than that particle where there is none.\n\n"
    "Keys of the summary in a state's history:\n"
    "  method, pairs           pairs that overlapped\n"
    "  bonds, mean_diameter, mean_length (m)\n"
    "  coordination_number     bond ends per particle\n"
    "  thin                    bonds below --thin-below, kept or not\n"
    "of exact and sweep\n"
    "  sharing, volume         as the options say\n"
    "  clamped, clamped_percent  bonds as thick as their smaller particle; of all\n"
    "  bond_volume             m3, that the particles gave to their bonds\n"
    "  lost_volume, lost_percent  m3, what does not fit into clamped bonds; of bond_volume, and E is\n"
    "                          lower by a fifth to a third of that percentage\n"
    "  dropped_volume, dropped_percent  m3, of thin bonds left out; of bond_volume\n"
    "  stopped                 particles that stopped shrinking\n"
    "  volume_error            solid after over solid before, minus one\n"
    "of necks\n"
    "  necks, neck_factor, solid_fraction, union_fraction, union_error\n"
    "  limited, limited_percent  as above; of all necks\n\n"
    "Examples:\n"
    "  sinter --temperature 1200C --to-density 0.67,0.79 green.kiln | bondify | analyze bonds --table\n"
    "  bondify --method necks sintered.kiln | analyze elastic --table\n"
    "  bondify --method necks --necks law sintered.kiln | analyze info | jq .last_step.summary\n"
    "  bondify --method sweep --decrement 0.01nm sintered.kiln -o bonded.kiln\n"
    "  bondify --volume cap-corrected sintered.kiln | bend | analyze modulus";

}  // namespace

void add_options(CLI::App& app, bonding::Options& options) {
    using physics::BondVolume;
    app.description(description);
    app.footer(footer);
    cli::add_choice(app, "--method", options.method, {{"exact", Method::exact}, {"sweep", Method::sweep}, {"necks", Method::necks}},
                    "exact: Eq. 2-4 in the limit of small decrements; sweep: Eq. 2-3 as they stand, slow; necks: the necks of the "
                    "sintering law between particles that keep their radii");
    cli::add_choice(app, "--necks", options.necks, {{"mass", Necks::mass}, {"law", Necks::law}},
                    "Size of necks. mass: one factor on all, so that particles and necks fill what the mass fills; law: as the "
                    "sintering law has them");
    const auto* decrement_option = cli::add_quantity(app, "--decrement", options.decrement, io::Dimension::length,
                                                     "What a sweep takes off a radius", "0.0001nm");
    cli::add_choice(app, "--sharing", options.sharing, {{"pair", Sharing::pair}, {"particle", Sharing::particle}},
                    "pair: a particle with k overlaps loses k decrements a sweep (Eq. 2); particle: it loses one decrement a "
                    "sweep. Either way its k bonds get equal parts of what it loses");
    cli::add_choice(app, "--volume", options.volume,
                    {{"cylinder", BondVolume::cylinder}, {"cap-corrected", BondVolume::cap_corrected}},
                    "What must equal the volume given to a bond. cylinder: the whole cylinder; cap-corrected: the cylinder "
                    "without the caps of the spheres inside it");
    cli::add_number(app, "--thin-below", options.thin_ratio, {0.0, 1.0},
                    "A bond is thin if its radius is below this fraction of the smaller particle's radius");
    app.add_flag("--drop-thin", options.drop_thin, "Leave thin bonds out; what volume they have is lost and reported");
    app.callback([&options, &app, decrement_option] {
        if (options.method == Method::necks) {
            for (const char* name : {"--sharing", "--volume"})
                if (app.count(name) > 0) throw CLI::ValidationError(name, "has no meaning with --method necks");
        } else if (app.count("--necks") > 0) {
            throw CLI::ValidationError("--necks", "requires --method necks");
        }
        if (!decrement_option->empty() && options.method != Method::sweep)
            throw CLI::ValidationError("--decrement", "requires --method sweep");
        if (!(options.decrement > 0.0)) throw CLI::ValidationError("--decrement", "must be greater than zero");
    });
}

}  // namespace kiln::bondify
