// incomplete_cholesky.h: incomplete factorisation of networks of nodes with three freedoms and edges with a 3x3 stiffness.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "linalg/quad.h"

namespace kiln::linalg {

/// A range of nodes that is factorised by itself. Edges [begin, inside) join two of its nodes, sorted by their first; of the edges
/// [inside, end) at least one node is its own, and they count on the diagonal only.
struct NodeRange {
    std::size_t first_node, last_node;
    std::size_t begin, inside, end;
};

/// Inverse of a symmetric positive semidefinite block of which elimination left `pivot` where `before` stood. Along directions
/// whose pivot is within `floor` of the trace from zero it is zero: a node that nothing but eliminated ones holds. Along
/// directions with a slightly negative pivot `before` counts: with zero there a preconditioner would not see that residual, and
/// conjugate gradients would end as converged without it. Nothing where the pivot is more negative than rounding makes it.
std::optional<Eigen::Matrix3d> pivot_inverse(const Eigen::Matrix3d& pivot, const Eigen::Matrix3d& before, double floor);

/// Incomplete block factorisation L D L^T without fill, IC(0), of the 3x3 blocks inside each range; positive definite. Exact where
/// no node of a range has two neighbours in later rows.
template <typename Real>
class IncompleteCholesky {
   public:
    /// first, second: the nodes of each edge.
    IncompleteCholesky(std::size_t nodes, std::span<const NodeRange> ranges, std::span<const std::int32_t> first,
                       std::span<const std::int32_t> second);

    /// Takes the present stiffness of the edges of one range; block(edge): its 3x3 block, double.
    template <typename Block>
    void factorise(const NodeRange& range, const Block& block_of) {
        assemble(range, block_of);
        eliminate(range);
    }

    /// z = M^-1 r for the nodes of one range.
    void apply(const NodeRange& range, const Quad<Real>* r, Quad<Real>* z) const;

   private:
    using Block3 = Eigen::Matrix<Real, 3, 3>;
    static Eigen::Map<Block3> block(std::vector<Real>& blocks, std::size_t index) {
        return Eigen::Map<Block3>(&blocks[block_size * index]);
    }
    template <typename Block>
    void assemble(const NodeRange& range, const Block& block_of);
    /// Calls visit(a, b) for the blocks of two rows, [a, a_end) and [b, b_end), that stand in the same column.
    template <typename Visit>
    void for_shared(std::size_t a, std::size_t a_end, std::size_t b, std::size_t b_end, const Visit& visit) const;
    void eliminate(const NodeRange& range);

    static constexpr std::size_t block_size = 9;  // numbers of a 3x3 block, by columns

    std::span<const std::int32_t> first_, second_;
    std::vector<std::size_t> row_begin_;     // blocks of a node's row, left of the diagonal
    std::vector<std::int32_t> column_;       // ascending in a row
    std::vector<std::size_t> place_;         // of each edge inside a range, its block
    std::vector<Real> lower_;                // L, and space to read the last column as four numbers; M stays symmetric
    std::vector<Eigen::Matrix3d> diagonal_;  // of the stiffness, then D
    std::vector<Real> inverse_;              // of D, as L
};

template <typename Real>
template <typename Block>
void IncompleteCholesky<Real>::assemble(const NodeRange& range, const Block& block_of) {
    for (std::size_t row = range.first_node; row < range.last_node; ++row) diagonal_[row].setZero();
    std::fill(lower_.begin() + static_cast<std::ptrdiff_t>(block_size * row_begin_[range.first_node]),
              lower_.begin() + static_cast<std::ptrdiff_t>(block_size * row_begin_[range.last_node]), Real{0});
    for (std::size_t edge = range.begin; edge < range.end; ++edge) {
        if (first_[edge] == second_[edge]) continue;  // its own image: no relative motion but by strain
        const Eigen::Matrix3d joint = block_of(edge);
        for (const std::int32_t node : {first_[edge], second_[edge]}) {
            const auto row = static_cast<std::size_t>(node);
            if (row >= range.first_node && row < range.last_node) diagonal_[row] += joint;
        }
        if (edge < range.inside) block(lower_, place_[edge]) -= joint.cast<Real>();
    }
}

}  // namespace kiln::linalg
