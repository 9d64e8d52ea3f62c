// aggregation.h: the coarse space of the multigrid preconditioner: aggregates of neighbours and their rigid motions.
#pragma once

#include <vector>

#include "linalg/block_matrix.h"
#include "linalg/node_geometry.h"

namespace kiln::linalg {

/// A node's aggregate and the aggregates' root nodes.
struct Aggregates {
    std::vector<std::int32_t> of;    // node -> aggregate
    std::vector<std::int32_t> root;  // aggregate -> node
};

/// Groups of a node and its neighbours, in the order of the nodes.
Aggregates find_aggregates(const BlockMatrix& matrix);

/// Block of a rigid motion: displacement and rotation at `arm` from a point that moves and turns by the six values.
Mat6 rigid_motion(const Vec3& arm);

/// Prolongation that moves every aggregate as a rigid body, about its root.
BlockMatrix rigid_prolongation(const Aggregates& aggregates, const NodeGeometry& geometry);

}  // namespace kiln::linalg
