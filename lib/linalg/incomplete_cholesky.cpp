// incomplete_cholesky.cpp: the diagonal blocks of the factorisation and its two triangular solves, range by range.
#include "linalg/incomplete_cholesky.h"

#include <Eigen/Dense>
#include <cmath>

#include "linalg/wide_registers.h"

namespace kiln::linalg {

namespace {

/// Part of a diagonal block's trace below which what elimination left of it is rounding of the blocks.
template <typename Real>
constexpr double min_pivot = sizeof(Real) == 4 ? 1e-6 : 1e-14;

/// Of the symmetric a b^T + b a^T the numbers beside the diagonal: yz, zx, xy.
Quad<double> mixed(Quad<double> a, Quad<double> b) {
    return in_order<1, 2, 0>(a) * in_order<2, 0, 1>(b) + in_order<2, 0, 1>(a) * in_order<1, 2, 0>(b);
}

/// m += the block of a spring.
void add(const SpringLanes& k, SymmetricBlock<double>& m) {
    const Quad<double> along = k.more * k.direction;
    m.diagonal += along * k.direction + k.across;
    m.off += in_order<1, 2, 0>(along) * in_order<2, 0, 1>(k.direction);
}

/// block -= K m K of a spring's block K = kt I + k n n^T: kt^2 m + n g^T + g n^T with g = kt k m n + k^2/2 (n m n) n.
void take(const SpringLanes& k, const SymmetricBlock<double>& m, SymmetricBlock<double>& block) {
    const Quad<double> seen = m * k.direction;
    const Quad<double> g = k.more * (k.across * seen + 0.5 * k.more * sum(k.direction * seen) * k.direction);
    const Quad<double> square = k.across * k.across, share = k.direction * g;
    block.diagonal -= square * m.diagonal + (share + share);
    block.off -= square * m.off + mixed(k.direction, g);
}

/// Inverse of a block that has one, by its minors; pivots of its L D L^T that are not above least have none.
bool invert(const SymmetricBlock<double>& m, double least, SymmetricBlock<double>& inverse) {
    const Vec3 d = vector(m.diagonal), o = vector(m.off);
    const double xx = d[1] * d[2] - o[0] * o[0], xy = o[0] * o[1] - o[2] * d[2], zx = o[2] * o[0] - o[1] * d[1];
    const double zz = d[0] * d[1] - o[2] * o[2], determinant = d[0] * xx + o[2] * xy + o[1] * zx;
    if (!(d[0] > least && zz > least * d[0] && determinant > least * zz)) return false;
    const double scale = 1.0 / determinant;
    inverse.diagonal = quad<double>(scale * xx, scale * (d[0] * d[2] - o[1] * o[1]), scale * zz);
    inverse.off = quad<double>(scale * (o[2] * o[1] - d[0] * o[0]), scale * zx, scale * xy);
    return true;
}

}  // namespace

Eigen::Matrix3d pivot_inverse(const Eigen::Matrix3d& pivot, const Eigen::Matrix3d& before, double floor) {
    const double least = floor * before.trace();
    const double first = pivot(0, 0), second = pivot(1, 1) - pivot(1, 0) * pivot(1, 0) / first;  // D of its L D L^T
    const double rest = pivot(2, 1) - pivot(2, 0) * pivot(1, 0) / first;
    const double third = pivot(2, 2) - pivot(2, 0) * pivot(2, 0) / first - rest * rest / second;
    if (first > least && second > least && third > least) return pivot.inverse();
    if (!std::isfinite(least)) return pivot;  // no number: the solve will say so
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> modes(pivot);
    Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();
    for (Eigen::Index mode = 0; mode < 3; ++mode) {
        const Vec3 along = modes.eigenvectors().col(mode);
        const double stiffness = modes.eigenvalues()[mode];
        if (std::abs(stiffness) <= least) continue;
        inverse += along * along.transpose() / (stiffness > 0.0 ? stiffness : along.dot(before * along));
    }
    return inverse;
}

template <typename Real>
IncompleteCholesky<Real>::IncompleteCholesky(std::size_t nodes, std::span<const NodeRange> ranges,
                                             std::span<const std::int32_t> first, std::span<const std::int32_t> second,
                                             const EdgeStiffness<Real>& springs)
    : first_(first), second_(second), springs_(springs), end_(nodes), diagonal_(nodes), inverse_(nodes) {
    for (const NodeRange& range : ranges) {
        std::size_t edge = range.begin;
        for (std::size_t node = range.first_node; node < range.last_node; ++node) {
            while (edge < range.inside && static_cast<std::size_t>(first[edge]) == node) ++edge;
            end_[node] = edge;
        }
    }
}

template <typename Real>
void IncompleteCholesky<Real>::factorise(const NodeRange& range) {
    // In double precision, since stiff springs take each other off where soft ones are left.
    std::vector<SymmetricBlock<double>> left(range.last_node - range.first_node);
    in_widest_registers([&] { add_springs(range, left.data()); });
    in_widest_registers([&] { eliminate(range, left.data()); });
}

/// left: of each node of the range, zero to begin with, the diagonal block of the stiffness.
template <typename Real>
void IncompleteCholesky<Real>::add_springs(const NodeRange& range, SymmetricBlock<double>* left) {
    for (std::size_t edge = range.begin; edge < range.inside; ++edge) {
        const auto spring = springs_.lanes(edge);
        add(spring, left[static_cast<std::size_t>(first_[edge]) - range.first_node]);
        add(spring, left[static_cast<std::size_t>(second_[edge]) - range.first_node]);
    }
    for (std::size_t edge = range.inside; edge < range.end; ++edge) {
        if (first_[edge] == second_[edge]) continue;  // its own image: no relative motion but by strain
        for (const std::int32_t node : {first_[edge], second_[edge]}) {
            const auto row = static_cast<std::size_t>(node);
            if (row >= range.first_node && row < range.last_node) add(springs_.lanes(edge), left[row - range.first_node]);
        }
    }
    for (std::size_t node = range.first_node; node < range.last_node; ++node)
        diagonal_[node] = SymmetricBlock<Real>(left[node - range.first_node]);
}

/// left: what elimination has left of each diagonal block of the range, the block itself to begin with.
template <typename Real>
void IncompleteCholesky<Real>::eliminate(const NodeRange& range, SymmetricBlock<double>* left) {
    std::size_t edge = range.begin;
    for (std::size_t node = range.first_node; node < range.last_node; ++node) {
        const SymmetricBlock<double> pivot = left[node - range.first_node];
        const SymmetricBlock<Real> before = diagonal_[node];
        SymmetricBlock<double> inverse;
        if (!invert(pivot, min_pivot<Real> * vector(before.diagonal).sum(), inverse))
            inverse = SymmetricBlock<double>(pivot_inverse(pivot.matrix(), before.matrix(), min_pivot<Real>));
        inverse_[node] = SymmetricBlock<Real>(inverse);
        while (edge < end_[node]) {
            const std::int32_t other = second_[edge];
            SymmetricBlock<double>& of_other = left[static_cast<std::size_t>(other) - range.first_node];
            const std::size_t first = edge++;
            if (edge == end_[node] || second_[edge] != other) {
                take(springs_.lanes(first), inverse, of_other);
                continue;
            }
            Eigen::Matrix3d block = springs_.spring(first).block();  // parallel edges are one
            for (; edge < end_[node] && second_[edge] == other; ++edge) block += springs_.spring(edge).block();
            of_other = SymmetricBlock<double>(Eigen::Matrix3d(of_other.matrix() - block * inverse.matrix() * block));
        }
    }
}

template <typename Real>
void IncompleteCholesky<Real>::apply(const NodeRange& range, const Quad<Real>* r, Quad<Real>* z) const {
    std::vector<Quad<Real>> sums(range.last_node - range.first_node);
    forward(range, sums.data(), [&](std::size_t node, Quad<Real> sum) { return z[node] = inverse_[node] * (r[node] + sum); });
    backward(range, z, [&](std::size_t node, Quad<Real> sum) { z[node] += inverse_[node] * sum; });
}

template class IncompleteCholesky<float>;
template class IncompleteCholesky<double>;

}  // namespace kiln::linalg
