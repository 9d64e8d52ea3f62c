// options.h: what the user can choose about the transition to the bonded-particle model.
#pragma once

#include "bonding/bondify.h"

namespace CLI {
class App;
}

namespace kiln::bondify {

/// Adds the options of the transition, with their help and checks, to the app.
void add_options(CLI::App& app, bonding::Options& options);

}  // namespace kiln::bondify
