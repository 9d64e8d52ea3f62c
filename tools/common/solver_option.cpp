// solver_option.cpp: the option, and silence of all processes but the first.
#include "tools/common/solver_option.h"

#include <CLI/CLI.hpp>

#include "tools/common/ranks.h"
#include "tools/common/tool.h"
#include "tools/common/value_options.h"

namespace kiln::cli {

namespace {

constexpr const char* nowhere = "/dev/null";

}  // namespace

void SolverOption::add_to(CLI::App& app) {
    add_choice(app, "--solver", petsc_, {{"multigrid", false}, {"petsc", true}},
               "What solves the linear systems. multigrid: conjugate gradients with our own multigrid, on one machine; petsc: the "
               "same with that of PETSc, divided among the processes that mpirun or srun starts, in programs that make PETSC=1 "
               "has built")
        ->check([](const std::string& word) {
            return word == "petsc" && !ranks::available()
                       ? std::string("this build has no PETSc; make PETSC=1 builds the programs with it")
                       : std::string();
        });
}

void SolverOption::begin(Common& common, std::initializer_list<std::string*> outputs) {
    if (!petsc_) return;
    ranks::begin();
    if (ranks::rank() == 0) return;
    common.quiet = true;
    common.verbose = false;
    common.output = nowhere;
    for (std::string* name : outputs)
        if (!name->empty()) *name = nowhere;
}

mechanics::LinearSolverMaker SolverOption::solver() const { return petsc_ ? ranks::solver() : mechanics::LinearSolverMaker(); }

StopRequest SolverOption::stop() const {
    if (ranks::count() == 1) return stop_requested;
    return [] { return ranks::any(stop_requested()); };
}

}  // namespace kiln::cli
