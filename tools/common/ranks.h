// ranks.h: the processes that share a run under MPI: the first one reads its input, writes and speaks for all.
#pragma once

#include <string>

#include "mechanics/linear_solver.h"

namespace kiln::cli::ranks {

/// How many copies of the program mpirun or srun has started, and which of them this one is: from the environment, before MPI says
/// it.
struct Launch {
    int rank = 0, count = 1;
};

Launch launched();

// What follows is defined twice, in tools/ranks/petsc.cpp and in tools/ranks/alone.cpp. All but rank() and count() are for all
// processes at the same place, and need begin().

/// Whether this build has PETSc.
bool available();

/// What solves with PETSc.
mechanics::LinearSolverMaker solver();

/// Starts MPI and PETSc, if that is still to be done.
void begin();

/// 0 and 1 before begin().
int rank();
int count();

/// Gives all the text of the first.
void broadcast(std::string& text);

/// Whether it is true of any.
bool any(bool mine);

/// After an error: true once all processes came here, so that the first one may speak for all; false if others go on working, from
/// which only abort() can save them.
bool all_failed();

/// Ends every process with the status.
[[noreturn]] void abort(int status);

/// Ends MPI, if it was started; gives the status of the first.
int end(int status);

}  // namespace kiln::cli::ranks
