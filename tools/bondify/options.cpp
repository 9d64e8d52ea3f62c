// options.cpp: the options of bondify, their help and what must not be combined.
#include "tools/bondify/options.h"

#include <CLI/CLI.hpp>
#include <map>

#include "tools/common/quantity_options.h"

namespace kiln::bondify {

namespace {

using bonding::Method, bonding::Sharing;

constexpr const char* description =
    "Turns overlapping particles into smaller ones that do not overlap, with a cylindrical bond between each two that did "
    "(Dosta et al. 2017, Eq. 2-4). Every state is written back with shrunk radii and with the arrays bonds.pair, image, radius "
    "(m), length (m) and volume (m3); solid volume is conserved.";

constexpr const char* footer =
    "A bond whose volume finds no room between its particles gets the smaller one's radius; a particle stops shrinking at 1 % "
    "of its radius. Both are counted in the state's history and in a warning.\n"
    "Examples:\n"
    "  sinter green.kiln --to-density 0.67,0.88 | bondify | analyze bonds --table\n"
    "  bondify --method sweep --decrement 0.01nm sintered.kiln -o bonded.kiln\n"
    "  bondify --volume cap-corrected sintered.kiln | bend | analyze modulus";

template <typename Value>
CLI::Option* add_choice(CLI::App& app, const std::string& name, Value& target, const std::map<std::string, Value>& choices,
                        const std::string& default_text, const std::string& help) {
    return app
        .add_option_function<std::string>(name, [&target, choices](const std::string& text) { target = choices.at(text); }, help)
        ->check(CLI::IsMember(choices))
        ->default_str(default_text);
}

}  // namespace

void add_options(CLI::App& app, bonding::Options& options) {
    app.description(description);
    app.footer(footer);
    add_choice(app, "--method", options.method, {{"exact", Method::exact}, {"sweep", Method::sweep}}, "exact",
                                           "exact: the limit of small decrements; sweep: Eq. 2-3 as they stand, slow");
    const auto* decrement_option = cli::add_quantity(app, "--decrement", options.decrement, io::Dimension::length,
                                                     "what a sweep takes from a radius", "0.0001nm");
    add_choice(app, "--sharing", options.sharing, {{"pair", Sharing::pair}, {"particle", Sharing::particle}}, "pair",
               "pair: a particle with k overlaps loses k decrements a sweep (Eq. 2); particle: it loses one decrement a sweep. "
               "Either way its k bonds share what it loses equally");
    add_choice(app, "--volume", options.volume,
               {{"cylinder", physics::BondVolume::cylinder}, {"cap-corrected", physics::BondVolume::cap_corrected}}, "cylinder",
               "what must equal the volume given to a bond: the whole cylinder, or the cylinder without the caps of the spheres "
               "inside it");
    app.add_option("--thin-below", options.thin_ratio,
                   "a bond is thin if its radius is below this share of the smaller particle's radius (plain number)")
        ->check(CLI::Range(0.0, 1.0))
        ->capture_default_str();
    app.add_flag("--drop-thin", options.drop_thin, "leave thin bonds out; their volume is lost and reported");
    app.callback([&options, decrement_option] {
        if (!decrement_option->empty() && options.method != Method::sweep)
            throw CLI::ValidationError("--decrement", "is of use with --method sweep only");
        if (!(options.decrement > 0.0)) throw CLI::ValidationError("--decrement", "must be greater than zero");
    });
}

}  // namespace kiln::bondify
