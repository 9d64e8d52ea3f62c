// solver_option.h: --solver of the programs that solve bond networks, and what several processes of one run do.
#pragma once

#include <initializer_list>
#include <string>

#include "core/stop.h"
#include "mechanics/linear_solver.h"

namespace CLI {
class App;
}

namespace kiln::cli {

struct Common;

class SolverOption {
   public:
    void add_to(CLI::App& app);

    bool petsc() const { return petsc_; }

    /// To be called once options are parsed: starts PETSc where it was chosen. Of several processes all but the first write
    /// nothing from then on, neither to the files that are named here nor words.
    void begin(Common& common, std::initializer_list<std::string*> outputs = {});

    /// What solves in the place of the library's own multigrid; empty for that.
    mechanics::LinearSolverMaker solver() const;

    /// cli::stop_requested, with the same answer for all processes, which must ask at the same places.
    StopRequest stop() const;

   private:
    bool petsc_ = false;
};

}  // namespace kiln::cli
