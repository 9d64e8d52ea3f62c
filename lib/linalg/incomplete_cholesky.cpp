// incomplete_cholesky.cpp: the diagonal blocks of the factorisation and its two triangular solves, range by range.
#include "linalg/incomplete_cholesky.h"

#include <Eigen/Dense>
#include <cmath>

namespace kiln::linalg {

namespace {

/// Part of a diagonal block's trace below which what elimination left of it is rounding of the blocks.
template <typename Real>
constexpr double min_pivot = sizeof(Real) == 4 ? 1e-6 : 1e-14;

/// The six numbers of a symmetric 3x3 block, one by one: of vectors of two doubles most would be spent on putting them in order.
struct Six {
    double xx = 0.0, yy = 0.0, zz = 0.0, yz = 0.0, zx = 0.0, xy = 0.0;

    Six() = default;
    explicit Six(const Eigen::Matrix3d& m) : xx(m(0, 0)), yy(m(1, 1)), zz(m(2, 2)), yz(m(2, 1)), zx(m(2, 0)), xy(m(1, 0)) {}

    Eigen::Matrix3d matrix() const {
        Eigen::Matrix3d m;
        m << xx, xy, zx, xy, yy, yz, zx, yz, zz;
        return m;
    }

    template <typename Spring>
    void add(const Spring& k) {
        const double x = k.more * k.x, y = k.more * k.y, z = k.more * k.z;
        xx += x * k.x + k.across;
        yy += y * k.y + k.across;
        zz += z * k.z + k.across;
        yz += y * k.z;
        zx += z * k.x;
        xy += x * k.y;
    }

    /// Takes off K m K of a spring's block K.
    template <typename Spring>
    void take(const Spring& k, const Six& m) {
        // All but m itself is n h^T + h n^T.
        const double mx = m.xx * k.x + m.xy * k.y + m.zx * k.z, my = m.xy * k.x + m.yy * k.y + m.yz * k.z,
                     mz = m.zx * k.x + m.yz * k.y + m.zz * k.z;
        const double square = k.across * k.across, mixed = k.across * k.more,
                     along = 0.5 * k.more * k.more * (k.x * mx + k.y * my + k.z * mz);
        const double hx = mixed * mx + along * k.x, hy = mixed * my + along * k.y, hz = mixed * mz + along * k.z;
        xx -= square * m.xx + 2.0 * k.x * hx;
        yy -= square * m.yy + 2.0 * k.y * hy;
        zz -= square * m.zz + 2.0 * k.z * hz;
        yz -= square * m.yz + (k.y * hz + k.z * hy);
        zx -= square * m.zx + (k.z * hx + k.x * hz);
        xy -= square * m.xy + (k.x * hy + k.y * hx);
    }
};

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
    std::vector<Six> left(range.last_node - range.first_node);  // of each diagonal block
    for (std::size_t edge = range.begin; edge < range.inside; ++edge) {
        const auto spring = springs_.spring(edge);
        left[static_cast<std::size_t>(first_[edge]) - range.first_node].add(spring);
        left[static_cast<std::size_t>(second_[edge]) - range.first_node].add(spring);
    }
    for (std::size_t edge = range.inside; edge < range.end; ++edge) {
        if (first_[edge] == second_[edge]) continue;  // its own image: no relative motion but by strain
        for (const std::int32_t node : {first_[edge], second_[edge]}) {
            const auto row = static_cast<std::size_t>(node);
            if (row >= range.first_node && row < range.last_node) left[row - range.first_node].add(springs_.spring(edge));
        }
    }
    for (std::size_t node = range.first_node; node < range.last_node; ++node)
        diagonal_[node] = SymmetricBlock<Real>(left[node - range.first_node].matrix());
    std::size_t edge = range.begin;
    for (std::size_t node = range.first_node; node < range.last_node; ++node) {
        const Eigen::Matrix3d inverse =
            pivot_inverse(left[node - range.first_node].matrix(), diagonal_[node].matrix(), min_pivot<Real>);
        inverse_[node] = SymmetricBlock<Real>(inverse);
        const Six six(inverse);
        while (edge < end_[node]) {
            const std::int32_t other = second_[edge];
            Six& of_other = left[static_cast<std::size_t>(other) - range.first_node];
            const std::size_t first = edge++;
            if (edge == end_[node] || second_[edge] != other) {
                of_other.take(springs_.spring(first), six);
                continue;
            }
            Eigen::Matrix3d block = springs_.spring(first).block();  // parallel edges are one
            for (; edge < end_[node] && second_[edge] == other; ++edge) block += springs_.spring(edge).block();
            of_other = Six(of_other.matrix() - block * inverse * block);
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
