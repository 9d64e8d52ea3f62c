// multigrid.cpp: hierarchy of aggregates, Chebyshev smoothing and the V-cycle.
#include "linalg/multigrid.h"

#include <Eigen/LU>
#include <array>
#include <cmath>

#include "linalg/aggregation.h"
#include "linalg/block_row.h"

namespace kiln::linalg {

namespace {

constexpr std::int32_t coarsest_nodes = 150;        // factorised densely: 900 unknowns
constexpr double prolongation_damping = 4.0 / 3.0;  // over the largest eigenvalue (Vanek et al. 1996)
constexpr double smoothed_part = 0.2;               // the smoother damps eigenvalues from this share of the largest one upwards
constexpr int power_steps = 10;
constexpr double power_margin = 1.1;  // the power iteration ends below the largest eigenvalue

std::size_t at(std::int64_t index) { return static_cast<std::size_t>(index); }

std::vector<Mat6> inverse_diagonal(const BlockMatrix& matrix) {
    std::vector<Mat6> inverse(at(matrix.rows()));
    for_rows(inverse.size(), [&](std::size_t index) {
        const auto row = static_cast<std::int32_t>(index);
        for (std::int64_t k = matrix.first(row); k < matrix.last(row); ++k) {
            if (matrix.column[at(k)] == row) inverse[index] = matrix.block[at(k)].llt().solve(Mat6::Identity());
        }
    }, worth_threads);
    return inverse;
}

/// Largest eigenvalue of the block-Jacobi matrix, by power iteration from a fixed rough vector.
double max_eigenvalue(const BlockMatrix& matrix, const std::vector<Mat6>& inverse) {
    Vector x(inverse.size()), y;
    for (std::size_t i = 0; i < x.size(); ++i) {
        for (int k = 0; k < 6; ++k) x[i][k] = std::sin(1.0 + 12.9898 * static_cast<double>(i) + 78.233 * k);
    }
    double value = 0.0;
    for (int step = 0; step < power_steps; ++step) {
        const double scale = 1.0 / norm(x);
        for (Vec6& each : x) each *= scale;
        multiply(matrix, x, y);
        for_rows(y.size(), [&](std::size_t i) { x[i] = inverse[i] * y[i]; }, worth_threads);
        value = norm(x);
    }
    return power_margin * value;
}

/// (I - omega D^-1 A) P.
BlockMatrix smoothed(const BlockMatrix& matrix, const std::vector<Mat6>& inverse, double omega, const BlockMatrix& rigid) {
    BlockMatrix result = product(matrix, rigid);
    for_rows(inverse.size(), [&](std::size_t index) {
        const auto row = static_cast<std::int32_t>(index);
        const Mat6 factor = -omega * inverse[index];
        for (std::int64_t k = result.first(row); k < result.last(row); ++k) {
            Mat6& block = result.block[at(k)];
            block = factor * block;
            if (result.column[at(k)] == rigid.column[index]) block += rigid.block[index];
        }
    }, worth_threads);
    return result;
}

Eigen::MatrixXd dense(const BlockMatrix& matrix) {
    const auto from = [](std::int32_t block) { return 6 * static_cast<Eigen::Index>(block); };
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(from(matrix.rows()), from(matrix.columns));
    for (std::int32_t row = 0; row < matrix.rows(); ++row) {
        for (std::int64_t k = matrix.first(row); k < matrix.last(row); ++k) {
            result.block<6, 6>(from(row), from(matrix.column[at(k)])) = matrix.block[at(k)];
        }
    }
    return result;
}

/// Blocks times a factor in the precision of the levels.
template <typename Real>
std::vector<Eigen::Matrix<Real, 6, 6>> rounded(const std::vector<Mat6>& blocks, double factor) {
    std::vector<Eigen::Matrix<Real, 6, 6>> result(blocks.size());
    for_rows(blocks.size(), [&](std::size_t k) { result[k] = (factor * blocks[k]).template cast<Real>(); }, worth_threads);
    return result;
}

template <typename Real>
BasicBlockMatrix<Real> rounded(const BlockMatrix& matrix, double factor) {
    return {matrix.columns, matrix.start, matrix.column, rounded<Real>(matrix.block, factor)};
}

/// A power of two that takes the greatest diagonal value of a matrix to the order of one: single precision has a narrow range.
double unit_scale(const BlockMatrix& matrix) {
    double greatest = 0.0;
    for (std::int32_t row = 0; row < matrix.rows(); ++row)
        for (std::int64_t k = matrix.first(row); k < matrix.last(row); ++k)
            if (matrix.column[at(k)] == row) greatest = std::max(greatest, matrix.block[at(k)].diagonal().maxCoeff());
    return greatest > 0.0 && std::isfinite(greatest) ? std::exp2(-std::ilogb(greatest)) : 1.0;
}

template <typename Real, int lanes>
Values<Real, lanes> row_of_product(const BasicBlockMatrix<Real>& matrix, std::size_t row,
                                   const std::vector<Values<Real, lanes>>& x) {
    const auto first = at(matrix.start[row]);
    return sum_of_terms<Real, lanes>(matrix.start[row + 1] - matrix.start[row], [&](std::int64_t k) {
        return Term<Real, lanes>{&matrix.block[first + at(k)], &x[at(matrix.column[first + at(k)])]};
    });
}

template <typename Real, int lanes>
Values<Real, lanes> block_product(const Eigen::Matrix<Real, 6, 6>& block, const Values<Real, lanes>& x) {
    return sum_of_terms<Real, lanes>(1, [&](std::int64_t) { return Term<Real, lanes>{&block, &x}; });
}

}  // namespace

template <typename Real>
BasicMultigrid<Real>::BasicMultigrid(const BlockMatrix& matrix, NodeGeometry geometry, double max_eigenvalue) {
    build(matrix, std::move(geometry), max_eigenvalue);
}

template <typename Real>
void BasicMultigrid<Real>::build(const BlockMatrix& finest, NodeGeometry geometry, double max_eigenvalue_bound) {
    scale_ = unit_scale(finest);
    BlockMatrix coarse;  // of the level, but for the finest
    while (true) {
        const BlockMatrix& matrix = levels_.empty() ? finest : coarse;
        Level& level = levels_.emplace_back();
        level.nodes = at(matrix.rows());
        level.blocks = matrix.block.size();
        if (matrix.rows() <= coarsest_nodes) {
            Eigen::MatrixXd full = scale_ * dense(matrix);
            full.diagonal().array() += 1e-14 * full.diagonal().maxCoeff();
            coarsest_.compute(full);
            return;
        }
        const std::vector<Mat6> inverse = inverse_diagonal(matrix);
        level.max_eigenvalue = levels_.size() == 1 ? max_eigenvalue_bound : max_eigenvalue(matrix, inverse);
        const Aggregates aggregates = find_aggregates(matrix);
        // Each level has fewer nodes than the one before, so the loop ends; nodes that nothing connects would never become fewer.
        if (aggregates.root.size() >= at(matrix.rows()))
            throw Error("the matrix has " + std::to_string(matrix.rows()) +
                        " nodes that nothing connects, so it cannot be coarsened");
        const BlockMatrix prolongation = smoothed(matrix, inverse, prolongation_damping / level.max_eigenvalue,
                                                  rigid_prolongation(aggregates, geometry));
        level.restriction = column_index(prolongation);
        BlockMatrix coarser = transposed_product(prolongation, level.restriction, product(matrix, prolongation));
        level.prolongation = rounded<Real>(prolongation, 1.0);
        level.inverse_diagonal = rounded<Real>(inverse, 1.0 / scale_);
        level.matrix = rounded<Real>(matrix, scale_);
        coarse = std::move(coarser);
        std::vector<Vec3> roots;
        for (const std::int32_t root : aggregates.root) roots.push_back(geometry.position[at(root)]);
        geometry.position = std::move(roots);
    }
}

template <typename Real>
double BasicMultigrid<Real>::complexity() const {
    double blocks = 0.0;
    for (const Level& level : levels_) blocks += static_cast<double>(level.blocks);
    return blocks / static_cast<double>(levels_.front().blocks);
}

/// Two steps of the Chebyshev iteration (Saad, Iterative Methods for Sparse Linear Systems, 2003, algorithm 12.1).
template <typename Real>
template <int lanes>
void BasicMultigrid<Real>::smooth(const Level& level, Fields<lanes>& fields, bool from_zero) const {
    const double high = level.max_eigenvalue, low = smoothed_part * high;
    const double theta = (high + low) / 2.0, delta = (high - low) / 2.0;
    const double first_rho = delta / theta, second_rho = 1.0 / (2.0 * theta / delta - first_rho);
    const std::array factors{std::array{0.0, 1.0 / theta}, std::array{second_rho * first_rho, 2.0 * second_rho / delta}};
    auto& [load, solution, steps] = fields;
    // clang lets no structured binding into a lambda
    std::vector<Values<Real, lanes>>&loads = load, &x = solution, &last = steps;
    for (std::size_t step = 0; step < factors.size(); ++step) {
        const Real memory = static_cast<Real>(factors[step][0]), gain = static_cast<Real>(factors[step][1]);
        if (from_zero && step == 0) {
            for_rows(level.nodes, [&](std::size_t i) {
                last[i] = gain * block_product(level.inverse_diagonal[i], loads[i]);
                x[i] = last[i];
            }, worth_threads);
            continue;
        }
        const bool first = step == 0;  // whatever stands in the step is not from this iteration
        for_rows(level.nodes, [&](std::size_t i) {
            const Values<Real, lanes> rest = loads[i] - row_of_product(level.matrix, i, x);
            const Values<Real, lanes> change = gain * block_product(level.inverse_diagonal[i], rest);
            if (first)
                last[i] = change;
            else
                last[i] = memory * last[i] + change;
        }, worth_threads);
        for_rows(level.nodes, [&](std::size_t i) { x[i] += last[i]; }, worth_threads);
    }
}

template <typename Real>
template <int lanes>
void BasicMultigrid<Real>::solve_coarsest(Fields<lanes>& fields) const {
    using Unknowns = Eigen::Matrix<Real, Eigen::Dynamic, lanes, lanes == 1 ? Eigen::ColMajor : Eigen::RowMajor>;
    const auto size = static_cast<Eigen::Index>(6 * fields.load.size());
    const Eigen::Map<const Unknowns> load(fields.load.front().data(), size, lanes);
    const Eigen::MatrixXd solution = coarsest_.solve(load.template cast<double>());
    Eigen::Map<Unknowns>(fields.solution.front().data(), size, lanes) = solution.template cast<Real>();
}

template <typename Real>
template <int lanes>
void BasicMultigrid<Real>::cycle(std::size_t index) {
    Fields<lanes>& here = fields<lanes>()[index];
    if (index + 1 == levels_.size()) return solve_coarsest(here);
    const Level& level = levels_[index];
    Fields<lanes>& coarser = fields<lanes>()[index + 1];
    smooth(level, here, true);
    for_rows(level.nodes, [&](std::size_t i) {
        here.step[i] = here.load[i] - row_of_product(level.matrix, i, here.solution);
    }, worth_threads);
    for_rows(coarser.load.size(), [&](std::size_t a) {
        const auto entries = level.restriction.of(a);
        coarser.load[a] = sum_of_terms<Real, lanes, true>(std::ssize(entries), [&](std::int64_t k) {
            const auto [row, block] = entries[at(k)];
            return Term<Real, lanes>{&level.prolongation.block[at(block)], &here.step[at(row)]};
        });
    }, worth_threads);
    cycle<lanes>(index + 1);
    for_rows(level.nodes, [&](std::size_t i) {
        here.solution[i] += row_of_product(level.prolongation, i, coarser.solution);
    }, worth_threads);
    smooth(level, here, false);
}

/// Fields go to the levels with a norm of one, whatever their unit.
template <typename Real>
template <int width>
void BasicMultigrid<Real>::apply(const Batch<width>& r, Batch<width>& z) {
    constexpr int lanes = width == 1 ? 1 : six;
    std::vector<Fields<lanes>>& all = fields<lanes>();
    while (all.size() < levels_.size()) {
        const std::size_t nodes = levels_[all.size()].nodes;
        const std::vector<Values<Real, lanes>> zero(nodes, Values<Real, lanes>::Zero());
        all.push_back({zero, zero, zero});
    }
    const PerField<width> size = norms<width>(r);
    const PerField<width> inwards = (size > 0.0).select(size.inverse(), 0.0), outwards = scale_ * size;
    std::vector<Values<Real, lanes>>&load = all.front().load, &solution = all.front().solution;
    z.resize(r.size());
    for_rows(r.size(), [&](std::size_t i) {
        load[i].template leftCols<width>() = (r[i] * inwards.matrix().asDiagonal()).template cast<Real>();
    }, worth_threads);
    cycle<lanes>(0);
    for_rows(r.size(), [&](std::size_t i) {
        z[i] = solution[i].template leftCols<width>().template cast<double>() * outwards.matrix().asDiagonal();
    }, worth_threads);
}

template class BasicMultigrid<float>;
template void BasicMultigrid<float>::apply(const Batch<1>&, Batch<1>&);
template void BasicMultigrid<float>::apply(const Batch<6>&, Batch<6>&);
template class BasicMultigrid<double>;  // shows what is the method's and what is rounding
template void BasicMultigrid<double>::apply(const Batch<1>&, Batch<1>&);
template void BasicMultigrid<double>::apply(const Batch<6>&, Batch<6>&);

}  // namespace kiln::linalg
