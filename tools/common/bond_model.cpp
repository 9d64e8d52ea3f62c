// bond_model.cpp: names and help of the bond laws on the command line.
#include "tools/common/bond_model.h"

#include "tools/common/value_options.h"

namespace kiln::cli {

void add_bond_model(CLI::App& app, mechanics::BondModel& model) {
    using physics::BondLaw, physics::BondShear;
    add_choice(app, "--bond-law", model.law,
               {
                   {"auto", std::nullopt},
                   {"series", BondLaw::series},
                   {"solid", BondLaw::solid},
                   {"neck", BondLaw::neck},
                   {"centre", BondLaw::centre},
               },
               "What is elastic between two particles. series: the bond and both spheres, cut where it begins; solid: the same "
               "with the constriction of thin bonds and what all bonds of a sphere share of it; neck: the bond alone; centre: a "
               "cylinder of its radius from centre to centre; auto: solid for necks (bonds without a volume of their own), else "
               "series");
    add_choice(app, "--bond-shear", model.shear, {{"section", BondShear::section}, {"timoshenko", BondShear::timoshenko}},
               "What yields to a transverse force. section: the shear of the sections; timoshenko: that and the bond's bending; "
               "solid has both and takes neither")
        ->default_str("section");
    app.parse_complete_callback([&model] {
        if (model.law == BondLaw::solid && model.shear)
            throw CLI::ValidationError("--bond-shear", "has no meaning with --bond-law solid");
    });
}

}  // namespace kiln::cli
