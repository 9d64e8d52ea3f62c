// bond_model.h: the options --bond-law and --bond-shear, the same in every tool that solves bond networks.
#pragma once

#include "mechanics/bond_network.h"

namespace CLI {
class App;
}

namespace kiln::cli {

/// Adds both options; their values go to model.
void add_bond_model(CLI::App& app, mechanics::BondModel& model);

}  // namespace kiln::cli
