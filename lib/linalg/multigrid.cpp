// multigrid.cpp: hierarchy of aggregates, Chebyshev smoothing and the V-cycle.
#include "linalg/multigrid.h"

#include <Eigen/LU>
#include <cmath>

#include "linalg/aggregation.h"

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
#pragma omp parallel for schedule(static) if (matrix.rows() > worth_threads)
    for (std::int32_t row = 0; row < matrix.rows(); ++row) {
        for (std::int64_t k = matrix.first(row); k < matrix.last(row); ++k) {
            if (matrix.column[at(k)] == row) inverse[at(row)] = matrix.block[at(k)].llt().solve(Mat6::Identity());
        }
    }
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
#pragma omp parallel for schedule(static) if (y.size() > worth_threads)
        for (std::size_t i = 0; i < y.size(); ++i) x[i] = inverse[i] * y[i];
        value = norm(x);
    }
    return power_margin * value;
}

/// (I - omega D^-1 A) P.
BlockMatrix smoothed(const BlockMatrix& matrix, const std::vector<Mat6>& inverse, double omega, const BlockMatrix& rigid) {
    BlockMatrix result = product(matrix, rigid);
#pragma omp parallel for schedule(static) if (result.rows() > worth_threads)
    for (std::int32_t row = 0; row < result.rows(); ++row) {
        const Mat6 factor = -omega * inverse[at(row)];
        for (std::int64_t k = result.first(row); k < result.last(row); ++k) {
            Mat6& block = result.block[at(k)];
            block = factor * block;
            if (result.column[at(k)] == rigid.column[at(row)]) block += rigid.block[at(row)];
        }
    }
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

}  // namespace

Multigrid::Multigrid(const BlockMatrix& matrix, NodeGeometry geometry, double max_eigenvalue_bound) {
    levels_.emplace_back();
    levels_.front().matrix = &matrix;
    levels_.front().max_eigenvalue = max_eigenvalue_bound;
    build(std::move(geometry));
    for (Level& level : levels_) {
        if (!level.matrix) level.matrix = &level.own;
    }
}

void Multigrid::build(NodeGeometry geometry) {
    while (true) {
        Level& level = levels_.back();
        const BlockMatrix& matrix = level.matrix ? *level.matrix : level.own;
        if (matrix.rows() <= coarsest_nodes) {
            Eigen::MatrixXd full = dense(matrix);
            full.diagonal().array() += 1e-14 * full.diagonal().maxCoeff();
            coarsest_.compute(full);
            return;
        }
        level.inverse_diagonal = inverse_diagonal(matrix);
        if (level.max_eigenvalue == 0.0) level.max_eigenvalue = max_eigenvalue(matrix, level.inverse_diagonal);
        const Aggregates aggregates = find_aggregates(matrix);
        // Each level has fewer nodes than the one before, so the loop ends; nodes that nothing connects would never become fewer.
        if (aggregates.root.size() >= at(matrix.rows()))
            throw Error("the matrix has " + std::to_string(matrix.rows()) +
                        " nodes that nothing connects, so it cannot be coarsened");
        level.prolongation = smoothed(matrix, level.inverse_diagonal, prolongation_damping / level.max_eigenvalue,
                                      rigid_prolongation(aggregates, geometry));
        level.restriction = column_index(level.prolongation);
        std::vector<Vec3> roots;
        for (const std::int32_t root : aggregates.root) roots.push_back(geometry.position[at(root)]);
        geometry.position = std::move(roots);
        Level coarser;
        coarser.own = transposed_product(level.prolongation, level.restriction, product(matrix, level.prolongation));
        levels_.push_back(std::move(coarser));
    }
}

double Multigrid::complexity() const {
    double blocks = 0.0;
    for (const Level& level : levels_) blocks += static_cast<double>(level.matrix->block.size());
    return blocks / static_cast<double>(levels_.front().matrix->block.size());
}

/// Two steps of the Chebyshev iteration (Saad, Iterative Methods for Sparse Linear Systems, 2003, algorithm 12.1).
void Multigrid::smooth(Level& level, bool from_zero) {
    const BlockMatrix& matrix = *level.matrix;
    const double high = level.max_eigenvalue, low = smoothed_part * high;
    const double theta = (high + low) / 2.0, delta = (high - low) / 2.0;
    const double first_rho = delta / theta, second_rho = 1.0 / (2.0 * theta / delta - first_rho);
    const std::array factors{std::array{0.0, 1.0 / theta}, std::array{second_rho * first_rho, 2.0 * second_rho / delta}};
    const std::size_t size = level.load.size();
    for (std::size_t step = 0; step < factors.size(); ++step) {
        const double memory = factors[step][0], gain = factors[step][1];  // clang lets no structured binding into a parallel loop
        if (from_zero && step == 0) {
#pragma omp parallel for schedule(static) if (size > worth_threads)
            for (std::size_t i = 0; i < size; ++i) {
                level.step[i] = gain * (level.inverse_diagonal[i] * level.load[i]);
                level.solution[i] = level.step[i];
            }
            continue;
        }
#pragma omp parallel for schedule(static) if (size > worth_threads)
        for (std::size_t i = 0; i < size; ++i) {
            Vec6 rest = level.load[i];
            const auto row = static_cast<std::int32_t>(i);
            for (std::int64_t k = matrix.first(row); k < matrix.last(row); ++k) {
                rest.noalias() -= matrix.block[at(k)].lazyProduct(level.solution[at(matrix.column[at(k)])]);
            }
            level.step[i] = memory * level.step[i] + gain * (level.inverse_diagonal[i] * rest);
        }
        add(1.0, level.step, level.solution);
    }
}

void Multigrid::solve_coarsest(Level& level) {
    const auto size = static_cast<Eigen::Index>(6 * level.load.size());
    level.solution.resize(level.load.size());
    Eigen::Map<const Eigen::VectorXd> load(level.load.front().data(), size);
    Eigen::Map<Eigen::VectorXd>(level.solution.front().data(), size) = coarsest_.solve(load);
}

void Multigrid::cycle(std::size_t index) {
    Level& level = levels_[index];
    if (index + 1 == levels_.size()) return solve_coarsest(level);
    Level& coarser = levels_[index + 1];
    level.solution.resize(level.load.size());
    level.step.resize(level.load.size());
    smooth(level, true);
    Vector& rest = level.step;
    residual(*level.matrix, level.solution, level.load, rest);
    coarser.load.resize(at(level.prolongation.columns));
#pragma omp parallel for schedule(static) if (coarser.load.size() > worth_threads)
    for (std::size_t a = 0; a < coarser.load.size(); ++a) {
        Vec6 sum = Vec6::Zero();
        for (const auto& [row, block] : level.restriction.of(a)) {
            sum.noalias() += level.prolongation.block[at(block)].transpose() * rest[at(row)];
        }
        coarser.load[a] = sum;
    }
    cycle(index + 1);
    multiply(level.prolongation, coarser.solution, level.step);
    add(1.0, level.step, level.solution);
    smooth(level, false);
}

void Multigrid::apply(const Vector& r, Vector& z) {
    levels_.front().load = r;
    cycle(0);
    z = levels_.front().solution;
}

}  // namespace kiln::linalg
