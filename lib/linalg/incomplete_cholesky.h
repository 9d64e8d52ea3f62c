// incomplete_cholesky.h: incomplete factorisation of networks of nodes with three freedoms whose edges are springs.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "linalg/edge_stiffness.h"

namespace kiln::linalg {

/// A range of nodes that is factorised by itself. Edges [begin, inside) join two different ones of its nodes, sorted by first, with
/// first < second, parallel edges best beside each other; of the edges [inside, end) at least one node is its own, and they count
/// on the diagonal only.
struct NodeRange {
    std::size_t first_node, last_node;
    std::size_t begin, inside, end;
};

/// Inverse of a symmetric positive semidefinite block of which elimination left `pivot` where `before` stood. Along directions
/// whose pivot is within `floor` of the trace from zero it is zero: a node that nothing but eliminated ones holds. Along
/// directions with a negative pivot, rounding of stiff springs beside soft ones, `before` counts: with zero there a preconditioner
/// would not see that residual, and conjugate gradients would end as converged without it.
Eigen::Matrix3d pivot_inverse(const Eigen::Matrix3d& pivot, const Eigen::Matrix3d& before, double floor);

/// Incomplete factorisation M = (D + L) D^-1 (D + L^T) of the 3x3 blocks inside each range, in which L is that of the stiffness
/// itself and only the diagonal blocks change: D_j = A_jj - sum_i<j A_ji D_i^-1 A_ij. Exact where no node of a range has two
/// neighbours in later rows. Source: Barrett et al., Templates for the solution of linear systems, 1994, section 3.4 (D-ILU).
///
/// D never breaks down. A_jj is the sum of the springs K of node j, so if D_i >= sum of the K to later nodes, each of them has
/// K D_i^-1 K <= K, and D_j >= sum of the K of j to later nodes and out of the range. M is positive semidefinite with any rounding
/// of D^-1, and blind only along directions in which D_j is nothing.
template <typename Real>
class IncompleteCholesky {
   public:
    /// first, second: the nodes of each edge. Keeps references to them and to the springs.
    IncompleteCholesky(std::size_t nodes, std::span<const NodeRange> ranges, std::span<const std::int32_t> first,
                       std::span<const std::int32_t> second, const EdgeStiffness<Real>& springs);

    /// Takes the present stiffness of the springs of one range.
    void factorise(const NodeRange& range);

    /// z = M^-1 r for the nodes of one range.
    void apply(const NodeRange& range, const Quad<Real>* r, Quad<Real>* z) const;

    const SymmetricBlock<Real>& diagonal(std::size_t node) const { return diagonal_[node]; }  // of the stiffness
    const SymmetricBlock<Real>& inverse(std::size_t node) const { return inverse_[node]; }    // of D

    /// Goes through the nodes of a range from the first on. visit(node, sum) gives a value of the node; sum: that of the springs to
    /// earlier nodes times their values, beside what stood in sums to begin with. sums: one for each node of the range, used up.
    template <typename Visit>
    void forward(const NodeRange& range, Quad<Real>* sums, const Visit& visit) const {
        std::size_t edge = range.begin;
        for (std::size_t node = range.first_node; node < range.last_node; ++node) {
            const Quad<Real> value = visit(node, only_vector(sums[node - range.first_node]));
            for (; edge < end_[node]; ++edge)
                sums[static_cast<std::size_t>(second_[edge]) - range.first_node] += springs_.product(edge, value);
        }
    }

    /// Goes back from the last node. visit(node, sum) may set values[node]; sum: that of the springs to later nodes times their
    /// values.
    template <typename Visit>
    void backward(const NodeRange& range, const Quad<Real>* values, const Visit& visit) const {
        std::size_t edge = range.inside;
        for (std::size_t node = range.last_node; node-- > range.first_node;) {
            const std::size_t begin = node == range.first_node ? range.begin : end_[node - 1];
            Quad<Real> sum;
            while (edge > begin) {
                --edge;
                sum += springs_.product(edge, values[second_[edge]]);
            }
            visit(node, only_vector(sum));
        }
    }

   private:
    void add_springs(const NodeRange& range, SymmetricBlock<double>* left);
    void eliminate(const NodeRange& range, SymmetricBlock<double>* left);

    std::span<const std::int32_t> first_, second_;
    const EdgeStiffness<Real>& springs_;
    std::vector<std::size_t> end_;  // of the edges inside the range whose first node this is
    std::vector<SymmetricBlock<Real>> diagonal_, inverse_;
};

}  // namespace kiln::linalg
