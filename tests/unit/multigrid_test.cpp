// multigrid_test.cpp: what the multigrid preconditioner cannot coarsen it refuses, instead of trying without end.
#include <doctest/doctest.h>

#include <cmath>

#include "core/types.h"
#include "linalg/multigrid.h"

using namespace kiln;
using namespace kiln::linalg;

namespace {

/// Nodes on a line, each with a spring to a fixed place and nothing between them.
Springs<double> apart(std::size_t nodes) {
    Springs<double> springs(nodes, {});
    for (std::size_t node = 0; node < nodes; ++node) springs.hold(node, Vec6::Constant(2.0));
    return springs;
}

NodeGeometry on_a_line(std::int32_t nodes) {
    NodeGeometry geometry{{}, Vec3::Zero()};
    for (std::int32_t node = 0; node < nodes; ++node) geometry.position.push_back(Vec3(node, 0.0, 0.0));
    return geometry;
}

}  // namespace

TEST_CASE("multigrid: nodes that nothing connects are solved densely while they are few, and refused when they are many") {
    const Springs<double> few = apart(20), many = apart(400);
    const Vector load(20, Vec6::Ones());
    const auto check = [&]<typename Real>(Real rounding) {
        BasicMultigrid<Real> multigrid(few, on_a_line(20), 1.0);
        const auto [motion, unit] = multigrid.template apply<1>(load, PerField<1>(norm(load)));
        for (const auto& node : motion) CHECK((unit[0] * values_of(node) - 0.5 * Vec6::Ones()).norm() < rounding);
    };
    check(1e-12);
    check(1e-6f);
    CHECK_THROWS_WITH_AS(Multigrid(many, on_a_line(400), 1.0), doctest::Contains("400 nodes that nothing connects"), Error);
}
