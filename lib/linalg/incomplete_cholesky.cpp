// incomplete_cholesky.cpp: the block factorisation and its two triangular solves, range by range.
#include "linalg/incomplete_cholesky.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

namespace kiln::linalg {

namespace {

/// Part of a diagonal block's trace below which what elimination left of it is rounding of the blocks.
template <typename Real>
constexpr double min_pivot = sizeof(Real) == 4 ? 1e-6 : 1e-14;

/// Part of the trace beyond which a negative pivot is no rounding of factors with large contrasts.
constexpr double breakdown = 0.01;

constexpr std::size_t long_row = 64;  // blocks, from which bisection is quicker than going along

}  // namespace

std::optional<Eigen::Matrix3d> pivot_inverse(const Eigen::Matrix3d& pivot, const Eigen::Matrix3d& before, double floor) {
    const double trace = before.trace(), least = floor * trace;
    const double first = pivot(0, 0), second = pivot(1, 1) - pivot(1, 0) * pivot(1, 0) / first;  // D of its L D L^T
    const double rest = pivot(2, 1) - pivot(2, 0) * pivot(1, 0) / first;
    const double third = pivot(2, 2) - pivot(2, 0) * pivot(2, 0) / first - rest * rest / second;
    if (first > least && second > least && third > least) return pivot.inverse();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> modes(pivot);
    if (!(modes.eigenvalues()[0] >= -breakdown * trace)) return std::nullopt;
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
                                             std::span<const std::int32_t> first, std::span<const std::int32_t> second)
    : first_(first),
      second_(second),
      row_begin_(nodes + 1, 0),
      place_(first.size(), 0),
      diagonal_(nodes),
      inverse_(block_size * nodes + 1) {
    // Edges are sorted by their first node, so the blocks of a row come out sorted by column; parallel edges share a block.
    std::vector<std::int32_t> last(nodes, -1);  // column of the last block of each row
    const auto for_edges = [&](const auto& visit) {
        std::fill(last.begin(), last.end(), -1);
        for (const NodeRange& range : ranges)
            for (std::size_t edge = range.begin; edge < range.inside; ++edge) {
                const auto row = static_cast<std::size_t>(second[edge]);
                if (first[edge] == second[edge]) continue;
                visit(edge, row, std::exchange(last[row], first[edge]) != first[edge]);
            }
    };
    for_edges([&](std::size_t, std::size_t row, bool opens) { row_begin_[row + 1] += opens; });
    for (std::size_t row = 0; row < nodes; ++row) row_begin_[row + 1] += row_begin_[row];
    column_.resize(row_begin_.back());
    lower_.resize(block_size * row_begin_.back() + 1);
    std::vector<std::size_t> next(row_begin_.begin(), row_begin_.end() - 1);
    for_edges([&](std::size_t edge, std::size_t row, bool opens) {
        place_[edge] = opens ? next[row]++ : next[row] - 1;
        column_[place_[edge]] = first[edge];
    });
}

template <typename Real>
template <typename Visit>
void IncompleteCholesky<Real>::for_shared(std::size_t a, std::size_t a_end, std::size_t b, std::size_t b_end,
                                          const Visit& visit) const {
    if (a_end - a > long_row) {  // of a hub with many neighbours: look the few columns of the other row up
        for (; b < b_end; ++b) {
            const auto found = std::lower_bound(column_.begin() + static_cast<std::ptrdiff_t>(a),
                                                column_.begin() + static_cast<std::ptrdiff_t>(a_end), column_[b]);
            a = static_cast<std::size_t>(found - column_.begin());
            if (a == a_end) return;
            if (column_[a] == column_[b]) visit(a, b);
        }
        return;
    }
    while (a < a_end && b < b_end) {
        if (column_[a] == column_[b]) {
            visit(a, b);
            ++a;
            ++b;
        } else {
            column_[a] < column_[b] ? ++a : ++b;
        }
    }
}

template <typename Real>
void IncompleteCholesky<Real>::eliminate(const NodeRange& range) {
    // Row by row: U_ji = A_ji - sum_k L_jk U_ik^T over the columns k that rows j and i share, L_ji = U_ji D_i^-1,
    // D_j = A_jj - sum_i L_ji U_ji^T. Where fill that was left out makes D_j negative, row j keeps A_jj alone. So every row kept
    // has sum_i L_ji D_i L_ji^T of A_jj at most, which bounds L, and M is positive definite.
    std::vector<Eigen::Matrix3d> upper;  // U of row j
    for (std::size_t row = range.first_node; row < range.last_node; ++row) {
        const Eigen::Matrix3d before = diagonal_[row];
        const std::size_t begin = row_begin_[row], end = row_begin_[row + 1];
        upper.resize(end - begin);
        for (std::size_t place = begin; place < end; ++place) {
            const auto i = static_cast<std::size_t>(column_[place]);
            Eigen::Matrix3d u = block(lower_, place).template cast<double>();
            for_shared(begin, place, row_begin_[i], row_begin_[i + 1], [&](std::size_t a, std::size_t b) {
                u -= upper[a - begin] * block(lower_, b).template cast<double>().transpose();
            });
            upper[place - begin] = u;
            block(lower_, place) = (u * block(inverse_, i).template cast<double>()).template cast<Real>();
            diagonal_[row] -= block(lower_, place).template cast<double>() * u.transpose();
        }
        std::optional<Eigen::Matrix3d> inverse = pivot_inverse(diagonal_[row], before, min_pivot<Real>);
        if (!inverse) {
            std::fill(&lower_[block_size * begin], &lower_[block_size * end], Real{0});
            inverse = pivot_inverse(before, before, min_pivot<Real>).value_or(before);  // no number: the solve will say so
        }
        block(inverse_, row) = inverse->template cast<Real>();
    }
}

template <typename Real>
void IncompleteCholesky<Real>::apply(const NodeRange& range, const Quad<Real>* r, Quad<Real>* z) const {
    // The fourth number of a column is the next column's first: what it brings into spare places is cleared in the end.
    for (std::size_t row = range.first_node; row < range.last_node; ++row) {  // L y = r
        Quad<Real> y = r[row];
        for (std::size_t place = row_begin_[row]; place < row_begin_[row + 1]; ++place) {
            const Real* l = &lower_[block_size * place];
            const Quad<Real> known = z[column_[place]];
            y -= load(l) * all<0>(known) + load(l + 3) * all<1>(known) + load(l + 6) * all<2>(known);
        }
        z[row] = y;
    }
    for (std::size_t row = range.first_node; row < range.last_node; ++row) {  // D
        const Real* d = &inverse_[block_size * row];
        z[row] = load(d) * all<0>(z[row]) + load(d + 3) * all<1>(z[row]) + load(d + 6) * all<2>(z[row]);
    }
    for (std::size_t row = range.last_node; row-- > range.first_node;) {  // L^T z = y
        const Quad<Real> known = z[row] = only_vector(z[row]);
        for (std::size_t place = row_begin_[row]; place < row_begin_[row + 1]; ++place) {
            const Real* l = &lower_[block_size * place];
            z[column_[place]] -= transposed_product(load(l), load(l + 3), load(l + 6), known);
        }
    }
}

template class IncompleteCholesky<float>;
template class IncompleteCholesky<double>;

}  // namespace kiln::linalg
