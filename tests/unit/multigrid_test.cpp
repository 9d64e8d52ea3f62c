// multigrid_test.cpp: what the multigrid preconditioner cannot coarsen it refuses, instead of trying without end.
#include <doctest/doctest.h>

#include <cmath>

#include "core/types.h"
#include "linalg/multigrid.h"

using namespace kiln;
using namespace kiln::linalg;

namespace {

/// Nodes on a line, each with a spring to a fixed place and nothing between them.
BlockMatrix apart(std::int32_t nodes) {
    BlockMatrix matrix;
    matrix.columns = nodes;
    for (std::int32_t node = 0; node < nodes; ++node) {
        matrix.column.push_back(node);
        matrix.block.push_back(2.0 * Mat6::Identity());
        matrix.start.push_back(node + 1);
    }
    return matrix;
}

NodeGeometry on_a_line(std::int32_t nodes) {
    NodeGeometry geometry{{}, Vec3::Zero()};
    for (std::int32_t node = 0; node < nodes; ++node) geometry.position.push_back(Vec3(node, 0.0, 0.0));
    return geometry;
}

}  // namespace

TEST_CASE("multigrid: nodes that nothing connects are solved densely while they are few, and refused when they are many") {
    const BlockMatrix few = apart(20), many = apart(400);
    Vector load(20, Vec6::Ones()), solution;
    BasicMultigrid<double> multigrid(few, on_a_line(20), 1.0);
    multigrid.apply<1>(load, solution);
    for (const Vec6& node : solution) CHECK((node - 0.5 * Vec6::Ones()).norm() < 1e-12);
    Multigrid single(few, on_a_line(20), 1.0);
    single.apply<1>(load, solution);
    for (const Vec6& node : solution) CHECK((node - 0.5 * Vec6::Ones()).norm() < 1e-6);
    CHECK_THROWS_WITH_AS(Multigrid(many, on_a_line(400), 1.0), doctest::Contains("400 nodes that nothing connects"), Error);
}
