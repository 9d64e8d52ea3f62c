// aggregation.cpp: greedy aggregates and their rigid-body prolongation.
#include "linalg/aggregation.h"

#include <cmath>

namespace kiln::linalg {

namespace {

std::size_t at(std::int64_t index) { return static_cast<std::size_t>(index); }

}  // namespace

Aggregates find_aggregates(const BlockMatrix& matrix) {
    Aggregates aggregates;
    aggregates.of.assign(at(matrix.rows()), -1);
    const auto neighbours = [&](std::int32_t node) {
        return std::span(matrix.column).subspan(at(matrix.first(node)), at(matrix.last(node) - matrix.first(node)));
    };
    const auto begin_at = [&](std::int32_t node) {
        const auto aggregate = static_cast<std::int32_t>(aggregates.root.size());
        aggregates.root.push_back(node);
        aggregates.of[at(node)] = aggregate;
        for (const std::int32_t neighbour : neighbours(node)) {
            if (aggregates.of[at(neighbour)] < 0) aggregates.of[at(neighbour)] = aggregate;
        }
    };
    // Nodes none of whose neighbours is taken begin an aggregate.
    for (std::int32_t node = 0; node < matrix.rows(); ++node) {
        bool free = true;
        for (const std::int32_t neighbour : neighbours(node)) free = free && aggregates.of[at(neighbour)] < 0;
        if (free) begin_at(node);
    }
    // Of the others, each joins the neighbouring aggregate to which it is coupled most.
    const std::vector<std::int32_t> first_pass = aggregates.of;
    for (std::int32_t node = 0; node < matrix.rows(); ++node) {
        double strongest = 0.0;
        if (first_pass[at(node)] >= 0) continue;
        for (std::int64_t k = matrix.first(node); k < matrix.last(node); ++k) {
            const std::int32_t aggregate = first_pass[at(matrix.column[at(k)])];
            const double strength = matrix.block[at(k)].squaredNorm();
            if (aggregate < 0 || strength <= strongest) continue;
            strongest = strength;
            aggregates.of[at(node)] = aggregate;
        }
    }
    for (std::int32_t node = 0; node < matrix.rows(); ++node) {
        if (aggregates.of[at(node)] < 0) begin_at(node);
    }
    return aggregates;
}

Mat6 rigid_motion(const Vec3& arm) {
    Mat6 block = Mat6::Identity();
    // Rotation q moves the point by q x arm.
    block.topRightCorner<3, 3>() << 0.0, arm[2], -arm[1], -arm[2], 0.0, arm[0], arm[1], -arm[0], 0.0;
    return block;
}

BlockMatrix rigid_prolongation(const Aggregates& aggregates, const NodeGeometry& geometry) {
    BlockMatrix prolongation;
    prolongation.columns = static_cast<std::int32_t>(aggregates.root.size());
    for (std::size_t node = 0; node < aggregates.of.size(); ++node) {
        const std::int32_t aggregate = aggregates.of[node];
        prolongation.column.push_back(aggregate);
        prolongation.block.push_back(
            rigid_motion(geometry.between(aggregates.root[at(aggregate)], static_cast<std::int32_t>(node))));
        prolongation.start.push_back(static_cast<std::int64_t>(node) + 1);
    }
    return prolongation;
}

}  // namespace kiln::linalg
