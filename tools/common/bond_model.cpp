// bond_model.cpp: names and help of the bond laws on the command line.
#include "tools/common/bond_model.h"

#include <CLI/CLI.hpp>
#include <map>

namespace kiln::cli {

namespace {

template <typename Value>
void add_choice(CLI::App& app, const std::string& name, Value& target, const std::map<std::string, Value>& choices,
                const std::string& help) {
    app.add_option_function<std::string>(
           name, [&target, choices](const std::string& text) { target = choices.at(text); }, help)
        ->check(CLI::IsMember(choices))
        ->default_str(physics::name_of(target));
}

}  // namespace

void add_bond_model(CLI::App& app, mechanics::BondModel& model) {
    using physics::BondLaw, physics::BondShear;
    add_choice(
        app, "--bond-law", model.law, {{"series", BondLaw::series}, {"neck", BondLaw::neck}, {"centre", BondLaw::centre}},
        "what is elastic between two particles: series, the bond and both spheres cut where it begins; neck, the bond alone; "
        "centre, a cylinder of its radius from centre to centre");
    add_choice(app, "--bond-shear", model.shear, {{"section", BondShear::section}, {"timoshenko", BondShear::timoshenko}},
               "what yields to a transverse force: section, the shear of the sections; timoshenko, that and the bond's bending");
}

}  // namespace kiln::cli
