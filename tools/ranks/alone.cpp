// alone.cpp: a build without PETSc has one process; if mpirun started several all the same, the first one says that they cannot
// share anything.
#include <chrono>
#include <cstdlib>
#include <thread>

#include "tools/common/ranks.h"

namespace kiln::cli::ranks {

bool available() { return false; }

mechanics::LinearSolverMaker solver() { return {}; }

void begin() {}

int rank() { return launched().rank; }

int count() { return 1; }

void broadcast(std::string&) {}

bool any(bool mine) { return mine; }

/// mpirun ends all as soon as one has failed: the first one must have spoken by then.
bool all_failed() {
    if (rank() > 0) std::this_thread::sleep_for(std::chrono::seconds(1));
    return true;
}

void abort(int status) { std::exit(status); }

int end(int status) { return status; }

}  // namespace kiln::cli::ranks
