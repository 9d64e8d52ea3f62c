// options.h: the command line of bend.
#pragma once

#include <string>

#include "bending/options.h"
#include "tools/common/solver_option.h"

namespace CLI {
class App;
}

namespace kiln::bend {

/// The options of the test, and what only the program needs.
struct Options : bending::Options {
    std::string states;  // file of the deformed states; empty for none
    cli::SolverOption solver;

    void add_to(CLI::App& app);

   private:
    void add_dynamic(CLI::App& app);
    void add_strength(CLI::App& app);
    void check(const CLI::App& app) const;
};

}  // namespace kiln::bend
