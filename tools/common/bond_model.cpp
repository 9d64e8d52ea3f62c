// bond_model.cpp: names and help of the bond laws on the command line.
#include "tools/common/bond_model.h"

#include "tools/common/value_options.h"

namespace kiln::cli {

void add_bond_model(CLI::App& app, mechanics::BondModel& model) {
    using physics::BondLaw, physics::BondShear;
    add_choice(app, "--bond-law", model.law,
               {
                   {"series", BondLaw::series},
                   {"neck", BondLaw::neck},
                   {"centre", BondLaw::centre},
               },
               "What is elastic between two particles. series: the bond and both spheres, cut where it begins; neck: the bond "
               "alone; centre: a cylinder of its radius from centre to centre");
    add_choice(app, "--bond-shear", model.shear, {{"section", BondShear::section}, {"timoshenko", BondShear::timoshenko}},
               "What yields to a transverse force. section: the shear of the sections; timoshenko: that and the bond's bending");
}

}  // namespace kiln::cli
