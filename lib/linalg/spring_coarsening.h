// spring_coarsening.h: the matrix of the aggregates of nodes that springs connect.
#pragma once

#include "linalg/aggregation.h"

namespace kiln::linalg {

/// P^T A P with P = (I - damping D^-1 A) R, where R moves every aggregate as a rigid body and D is the diagonal of A. P and A P
/// exist for one chunk of nodes at a time.
BlockMatrix coarse_matrix(const Springs<double>& springs, const std::vector<Mat6>& inverse_diagonal, double damping,
                          const Aggregates& aggregates, const std::vector<Vec3>& arms);

}  // namespace kiln::linalg
