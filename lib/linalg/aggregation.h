// aggregation.h: the coarse space of the multigrid preconditioner: aggregates of neighbours and their rigid motions.
#pragma once

#include <vector>

#include "linalg/block_matrix.h"
#include "linalg/node_geometry.h"
#include "linalg/springs.h"

namespace kiln::linalg {

/// A node's aggregate and the aggregates' root nodes.
struct Aggregates {
    std::vector<std::int32_t> of;    // node -> aggregate
    std::vector<std::int32_t> root;  // aggregate -> node
};

/// How strongly a node is coupled to another one.
struct Coupling {
    std::int32_t node;
    float strength;
};

/// Of each node, its neighbours.
using Couplings = Grouping<Coupling>;

Couplings couplings_of(const BlockMatrix& matrix);
Couplings couplings_of(const Springs<double>& matrix);

/// Groups of a node and its neighbours, in the order of the nodes; rings: 1, or 2 where neighbours of neighbours belong to it. They
/// are packed against each other along a front that moves through the body, whatever the order of the nodes: with roots along a
/// space-filling curve more nodes are left between them, and conjugate gradients take a sixth more iterations.
Aggregates find_aggregates(const Couplings& couplings, int rings);

/// Block of a rigid motion: displacement and rotation at `arm` from a point that moves and turns by the six values.
Mat6 rigid_motion(const Vec3& arm);

/// From each node's root to the node.
std::vector<Vec3> arms_of(const Aggregates& aggregates, const NodeGeometry& geometry);

/// Prolongation that moves every aggregate as a rigid body, about its root.
BlockMatrix rigid_prolongation(const Aggregates& aggregates, const NodeGeometry& geometry);

}  // namespace kiln::linalg
