// aggregation.cpp: greedy aggregates and their rigid-body prolongation.
#include "linalg/aggregation.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/parallel.h"

namespace kiln::linalg {

namespace {

std::size_t at(std::int64_t index) { return static_cast<std::size_t>(index); }

/// Nodes breadth first, a front that starts at the first node and moves from neighbours to neighbours.
std::vector<std::int32_t> along_front(const Couplings& couplings) {
    const std::size_t nodes = couplings.begin.size() - 1;
    std::vector<std::int32_t> order;
    order.reserve(nodes);
    std::vector<bool> reached(nodes, false);
    const auto reach = [&](std::int32_t node) {
        if (reached[at(node)]) return;
        reached[at(node)] = true;
        order.push_back(node);
    };
    for (std::size_t first = 0; first < nodes; ++first) {
        std::size_t next = order.size();
        reach(static_cast<std::int32_t>(first));
        for (; next < order.size(); ++next)
            for (const Coupling& neighbour : couplings.of(at(order[next]))) reach(neighbour.node);
    }
    return order;
}

/// The same aggregates in the order of their roots.
Aggregates by_root(Aggregates aggregates) {
    std::vector<std::int32_t> number(aggregates.of.size(), 0);  // of a root
    for (const std::int32_t root : aggregates.root) number[at(root)] = 1;
    std::exclusive_scan(number.begin(), number.end(), number.begin(), 0);
    for (std::int32_t& aggregate : aggregates.of) aggregate = number[at(aggregates.root[at(aggregate)])];
    std::sort(aggregates.root.begin(), aggregates.root.end());
    return aggregates;
}

}  // namespace

Couplings couplings_of(const BlockMatrix& matrix) {
    return group_by<Coupling>(at(matrix.rows()), [&](const auto& visit) {
        for (std::int32_t row = 0; row < matrix.rows(); ++row)
            for (std::int64_t k = matrix.first(row); k < matrix.last(row); ++k)
                if (matrix.column[at(k)] != row)
                    visit(at(row), Coupling{matrix.column[at(k)], static_cast<float>(matrix.block[at(k)].norm())});
    });
}

Couplings couplings_of(const Springs<double>& matrix) {
    return group_by<Coupling>(matrix.nodes(), [&](const auto& visit) {
        for (const Spring<double>& spring : matrix.springs()) {
            if (spring.first == spring.second) continue;
            const Eigen::Map<const Vec3> arm(spring.arm);
            const auto strength = static_cast<float>(spring.shear + spring.axial * arm.squaredNorm());
            visit(at(spring.first), Coupling{spring.second, strength});
            visit(at(spring.second), Coupling{spring.first, strength});
        }
    });
}

Aggregates find_aggregates(const Couplings& couplings, int rings) {
    Aggregates aggregates;
    const auto nodes = static_cast<std::int32_t>(couplings.begin.size() - 1);
    aggregates.of.assign(at(nodes), -1);
    const auto begin_at = [&](std::int32_t root) {
        const auto aggregate = static_cast<std::int32_t>(aggregates.root.size());
        const auto take_free_neighbours = [&](std::int32_t node) {
            for (const Coupling& neighbour : couplings.of(at(node)))
                if (aggregates.of[at(neighbour.node)] < 0) aggregates.of[at(neighbour.node)] = aggregate;
        };
        aggregates.root.push_back(root);
        aggregates.of[at(root)] = aggregate;
        take_free_neighbours(root);
        if (rings == 1) return;
        for (const Coupling& neighbour : couplings.of(at(root)))
            if (aggregates.of[at(neighbour.node)] == aggregate) take_free_neighbours(neighbour.node);
    };
    // Nodes none of whose neighbours is taken begin an aggregate.
    for (const std::int32_t node : along_front(couplings)) {
        bool free = aggregates.of[at(node)] < 0;
        for (const Coupling& neighbour : couplings.of(at(node))) free = free && aggregates.of[at(neighbour.node)] < 0;
        if (free) begin_at(node);
    }
    // Of the others, each joins the neighbouring aggregate to which it is coupled most.
    const std::vector<std::int32_t> first_pass = aggregates.of;
    for (std::int32_t node = 0; node < nodes; ++node) {
        float strongest = 0.0f;
        if (first_pass[at(node)] >= 0) continue;
        for (const Coupling& neighbour : couplings.of(at(node))) {
            const std::int32_t aggregate = first_pass[at(neighbour.node)];
            if (aggregate < 0 || neighbour.strength <= strongest) continue;
            strongest = neighbour.strength;
            aggregates.of[at(node)] = aggregate;
        }
    }
    for (std::int32_t node = 0; node < nodes; ++node) {
        if (aggregates.of[at(node)] < 0) begin_at(node);
    }
    return by_root(std::move(aggregates));
}

Mat6 rigid_motion(const Vec3& arm) {
    Mat6 block = Mat6::Identity();
    // Rotation q moves the point by q x arm.
    block.topRightCorner<3, 3>() << 0.0, arm[2], -arm[1], -arm[2], 0.0, arm[0], arm[1], -arm[0], 0.0;
    return block;
}

std::vector<Vec3> arms_of(const Aggregates& aggregates, const NodeGeometry& geometry) {
    std::vector<Vec3> arms(aggregates.of.size());
    for_rows(arms.size(), [&](std::size_t node) {
        arms[node] = geometry.between(aggregates.root[at(aggregates.of[node])], static_cast<std::int32_t>(node));
    });
    return arms;
}

BlockMatrix rigid_prolongation(const Aggregates& aggregates, const NodeGeometry& geometry) {
    BlockMatrix prolongation;
    prolongation.columns = static_cast<std::int32_t>(aggregates.root.size());
    for (const Vec3& arm : arms_of(aggregates, geometry)) {
        const auto node = prolongation.column.size();
        prolongation.column.push_back(aggregates.of[node]);
        prolongation.block.push_back(rigid_motion(arm));
        prolongation.start.push_back(static_cast<std::int64_t>(node) + 1);
    }
    return prolongation;
}

}  // namespace kiln::linalg
