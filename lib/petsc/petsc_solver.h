// petsc_solver.h: the linear systems of a bond network solved by PETSc, each process with the rows of its part of the nodes.
#pragma once

#include "mechanics/linear_solver.h"

namespace kiln::petsc {

/// Conjugate gradients with smoothed aggregation (GAMG), whose near-null space is the network's rigid motions. PETSc must have been
/// started. All processes of PETSC_COMM_WORLD make the same calls with the same arguments; each builds the rows of its part of the
/// nodes, which are in spatial order, and all get the whole solution. Calls throw Error where PETSc fails; `stop` must give all
/// processes the same answer.
mechanics::LinearSolverMaker solver();

}  // namespace kiln::petsc
