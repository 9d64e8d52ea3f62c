// multigrid.cpp: hierarchy of aggregates, Chebyshev smoothing and the V-cycle.
#include "linalg/multigrid.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "linalg/aggregation.h"
#include "linalg/block_row.h"
#include "linalg/spring_coarsening.h"

namespace kiln::linalg {

namespace {

constexpr std::size_t coarsest_nodes = 150;        // factorised densely: 900 unknowns
constexpr double prolongation_damping = 4.0 / 3.0;  // over the largest eigenvalue (Vanek et al. 1996)
/// Steps of the smoother, and the share of the largest eigenvalue from which upwards it damps. Aggregates of the finest level are
/// larger, of two rings of neighbours: steps there are cheap.
struct Smoothing {
    int steps;
    double part;
};
constexpr Smoothing finest_smoothing{3, 0.1}, coarse_smoothing{2, 0.2};
constexpr int power_steps = 10;
constexpr double same_image = 1e-6;  // of a spring's length, by which its ends miss it: rounding, or else the period
constexpr double power_margin = 1.1;  // the power iteration ends below the largest eigenvalue

std::size_t at(std::int64_t index) { return static_cast<std::size_t>(index); }

std::vector<Mat6> inverse_diagonal(const BlockMatrix& matrix) {
    std::vector<Mat6> inverse(at(matrix.rows()));
    for_rows(
        inverse.size(),
        [&](std::size_t row) {
            for (std::int64_t k = matrix.start[row]; k < matrix.start[row + 1]; ++k)
                if (at(matrix.column[at(k)]) == row) inverse[row] = matrix.block[at(k)].llt().solve(Mat6::Identity());
        },
        worth_threads);
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
    for_rows(
        inverse.size(),
        [&](std::size_t row) {
            const Mat6 factor = -omega * inverse[row];
            for (std::int64_t k = result.start[row]; k < result.start[row + 1]; ++k) {
                Mat6& block = result.block[at(k)];
                block = factor * block;
                if (result.column[at(k)] == rigid.column[row]) block += rigid.block[row];
            }
        },
        worth_threads);
    return result;
}

/// Place of a node's first freedom in a dense matrix.
Eigen::Index from(std::int32_t node) { return 6 * static_cast<Eigen::Index>(node); }

Eigen::MatrixXd dense(const Springs<double>& matrix) {
    const Eigen::Index size = from(static_cast<std::int32_t>(matrix.nodes()));
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(size, size);
    for (const Spring<double>& spring : matrix.springs()) {
        const SpringBlocks blocks = blocks_of(spring);
        const Eigen::Index i = from(spring.first), j = from(spring.second);
        result.block<6, 6>(i, i) += blocks.ii;
        result.block<6, 6>(j, j) += blocks.jj;
        result.block<6, 6>(i, j) += blocks.ij;
        result.block<6, 6>(j, i) += blocks.ij.transpose();
    }
    for (const auto& [node, stiffness] : matrix.held())
        result.diagonal().segment<6>(from(static_cast<std::int32_t>(node))) += stiffness;
    return result;
}

Eigen::MatrixXd dense(const BlockMatrix& matrix) {
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

/// Takes the greatest stiffness to one: single precision has a narrow range, and rounds the same whatever the units.
double unit_scale(const Springs<double>& matrix) {
    double greatest = 0.0;
    for (const Spring<double>& spring : matrix.springs()) {
        const double arm = Eigen::Map<const Vec3>(spring.arm).squaredNorm();
        greatest = std::max({greatest, spring.shear + spring.axial * arm, spring.bending + spring.twisting * arm});
    }
    for (const auto& [node, stiffness] : matrix.held()) greatest = std::max(greatest, stiffness.maxCoeff());
    return greatest > 0.0 && std::isfinite(greatest) ? 1.0 / greatest : 1.0;
}

[[noreturn]] void throw_unconnected(std::size_t nodes) {
    throw Error("the matrix has " + std::to_string(nodes) + " nodes that nothing connects, so it cannot be coarsened");
}

std::vector<Vec3> roots_of(const Aggregates& aggregates, const NodeGeometry& geometry) {
    std::vector<Vec3> roots;
    for (const std::int32_t root : aggregates.root) roots.push_back(geometry.position[at(root)]);
    return roots;
}

/// Whether a spring lies in one aggregate, all of it in the same image of a periodic body: rigid motions do not strain it.
bool moves_rigidly(const Spring<double>& spring, const Aggregates& aggregates, const std::vector<Vec3>& arms) {
    const std::size_t i = at(spring.first), j = at(spring.second);
    const Vec3 along = 2.0 * Eigen::Map<const Vec3>(spring.arm);
    return aggregates.of[i] == aggregates.of[j] && (arms[i] + along - arms[j]).norm() < same_image * along.norm();
}

/// A step of the Chebyshev iteration: d <- memory d + gain D^-1 (b - A x), x <- x + d.
struct ChebyshevStep {
    double memory, gain;
};

/// Saad, Iterative Methods for Sparse Linear Systems, 2003, algorithm 12.1.
std::vector<ChebyshevStep> chebyshev_steps(const Smoothing& smoothing, double high) {
    const double low = smoothing.part * high, theta = (high + low) / 2.0, delta = (high - low) / 2.0;
    std::vector<ChebyshevStep> steps{{0.0, 1.0 / theta}};
    double rho = delta / theta;
    while (std::ssize(steps) < smoothing.steps) {
        const double next = 1.0 / (2.0 * theta / delta - rho);
        steps.push_back({next * rho, 2.0 * next / delta});
        rho = next;
    }
    return steps;
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

/// Motions of a node of the finest level as those of a coarser one, whose spare fields are zero.
template <typename Real, int width>
auto coarse(const Freedoms<Real, width>& motion) {
    constexpr int lanes = width == 1 ? 1 : 4;
    Values<Real, lanes> values;
    for (int component = 0; component < 6; ++component)
        std::copy_n(motion.data() + Freedoms<Real, width>::place(component, 0), lanes, values.data() + lanes * component);
    return values;
}

template <int width, typename Real, int lanes>
Freedoms<Real, width> fine(const Values<Real, lanes>& values) {
    Freedoms<Real, width> motion{};
    for (int component = 0; component < 6; ++component)
        std::copy_n(values.data() + lanes * component, lanes, motion.data() + Freedoms<Real, width>::place(component, 0));
    return motion;
}

}  // namespace

template <typename Real>
BasicMultigrid<Real>::BasicMultigrid(const Springs<double>& matrix, NodeGeometry geometry, double max_eigenvalue)
    : scale_(unit_scale(matrix)) {
    if (matrix.nodes() <= coarsest_nodes) {
        factorise(dense(matrix));
        return;
    }
    BlockMatrix coarser = build_finest(matrix, geometry, max_eigenvalue);
    build_coarser(std::move(coarser), std::move(geometry));
}

template <typename Real>
void BasicMultigrid<Real>::factorise(Eigen::MatrixXd matrix) {
    matrix *= scale_;
    matrix.diagonal().array() += 1e-14 * matrix.diagonal().maxCoeff();
    coarsest_.compute(matrix);
}

/// The coarser matrix; geometry: becomes that of the aggregates.
template <typename Real>
BlockMatrix BasicMultigrid<Real>::build_finest(const Springs<double>& matrix, NodeGeometry& geometry, double max_eigenvalue) {
    Aggregates aggregates = find_aggregates(couplings_of(matrix), 2);
    // Each level has fewer nodes than the one before; nodes that nothing connects would never become fewer.
    if (aggregates.root.size() >= matrix.nodes()) throw_unconnected(matrix.nodes());
    std::vector<Mat6> inverse = diagonal_blocks(matrix);
    for_rows(
        inverse.size(), [&](std::size_t node) { inverse[node] = inverse[node].llt().solve(Mat6::Identity()).eval(); },
        worth_threads);
    finest_.max_eigenvalue = max_eigenvalue;
    const std::vector<Vec3> arms = arms_of(aggregates, geometry);
    BlockMatrix coarser = coarse_matrix(matrix, inverse, prolongation_damping / max_eigenvalue, aggregates, arms);
    finest_.inverse_diagonal = rounded<Real>(inverse, 1.0 / scale_);
    finest_.springs = Springs<Real>(matrix, scale_, [&](const Spring<double>& spring) {
        return moves_rigidly(spring, aggregates, arms);
    });
    for (const Vec3& arm : arms)
        finest_.arm.push_back({static_cast<Real>(arm[0]), static_cast<Real>(arm[1]), static_cast<Real>(arm[2])});
    finest_.members = group_by<std::int32_t>(aggregates.root.size(), [&](const auto& visit) {
        for (std::size_t node = 0; node < aggregates.of.size(); ++node)
            visit(at(aggregates.of[node]), static_cast<std::int32_t>(node));
    });
    geometry.position = roots_of(aggregates, geometry);
    finest_.aggregate = std::move(aggregates.of);
    return coarser;
}

template <typename Real>
void BasicMultigrid<Real>::build_coarser(BlockMatrix matrix, NodeGeometry geometry) {
    while (true) {
        Level& level = levels_.emplace_back();
        level.nodes = at(matrix.rows());
        level.blocks = matrix.block.size();
        if (level.nodes <= coarsest_nodes) return factorise(dense(matrix));
        const std::vector<Mat6> inverse = inverse_diagonal(matrix);
        level.max_eigenvalue = max_eigenvalue(matrix, inverse);
        const Aggregates aggregates = find_aggregates(couplings_of(matrix), 1);
        if (aggregates.root.size() >= level.nodes) throw_unconnected(level.nodes);
        const BlockMatrix prolongation = smoothed(matrix, inverse, prolongation_damping / level.max_eigenvalue,
                                                  rigid_prolongation(aggregates, geometry));
        level.restriction = column_index(prolongation);
        BlockMatrix coarser = transposed_product(prolongation, level.restriction, product(matrix, prolongation));
        level.prolongation = rounded<Real>(prolongation, 1.0);
        level.inverse_diagonal = rounded<Real>(inverse, 1.0 / scale_);
        level.matrix = rounded<Real>(matrix, scale_);
        matrix = std::move(coarser);
        geometry.position = roots_of(aggregates, geometry);
    }
}

template <typename Real>
double BasicMultigrid<Real>::complexity() const {
    const auto finest = static_cast<double>(finest_.springs.nodes() + 2 * finest_.springs.springs().size());
    double blocks = finest;
    for (const Level& level : levels_) blocks += static_cast<double>(level.blocks);
    return finest > 0.0 ? blocks / finest : 1.0;
}

/// to <- x + memory (x - to) + gain D^-1 (load - A x), where the step before led from `to` to x. No residual is kept: each array
/// that a step goes through takes as long as the springs do.
template <typename Real>
template <int width>
void BasicMultigrid<Real>::step(const std::vector<Freedoms<Real, width>>& load, const std::vector<Freedoms<Real, width>>& x,
                                std::vector<Freedoms<Real, width>>& to, double memory, double gain) const {
    using Node = Freedoms<Real, width>;
    const Real factor = static_cast<Real>(gain), kept = static_cast<Real>(memory);
    for_chunks(finest_.springs.chunks(), [&](std::size_t chunk) {
        finest_.springs.template for_forces<width>(chunk, x, [&](std::size_t node, const Node& force) {
            const Node change = factor * (finest_.inverse_diagonal[node] * (load[node] - force));
            to[node] = kept == Real{0} ? x[node] + change : x[node] + (kept * (x[node] - to[node]) + change);
        });
    });
}

/// What the prolongation P = (I - omega D^-1 A) R does is done by the springs. R^T (I - omega A D^-1) (b - A x) is R^T (b - A y)
/// with y = x + omega D^-1 (b - A x). Springs that move with an aggregate have no part in A R, nor in R^T A.
template <typename Real>
template <int width>
void BasicMultigrid<Real>::cycle(AllFields<width>& fields) {
    using Node = Freedoms<Real, width>;
    auto& [load, x, other, rest] = fields.finest;
    if (levels_.empty()) return solve_coarsest<width>(load, x);
    std::vector<Node>&loads = load, &solution = x, &turns = other, &left = rest;
    const std::vector<ChebyshevStep> smoother = chebyshev_steps(finest_smoothing, finest_.max_eigenvalue);
    const double damping = prolongation_damping / finest_.max_eigenvalue;
    const Springs<Real>& springs = finest_.springs;
    for_rows(
        loads.size(),
        [&](std::size_t node) {
            turns[node] = Node{};
            solution[node] = static_cast<Real>(smoother[0].gain) * (finest_.inverse_diagonal[node] * loads[node]);
        },
        worth_threads);
    const auto smooth_on = [&] {
        for (std::size_t k = 1; k < smoother.size(); ++k) {
            step(loads, solution, turns, smoother[k].memory, smoother[k].gain);
            std::swap(solution, turns);
        }
    };
    smooth_on();
    step(loads, solution, turns, 0.0, damping);
    for_chunks(springs.chunks(), [&](std::size_t chunk) {
        springs.template for_forces<width, Which::active>(
            chunk, turns, [&](std::size_t node, const Node& force) { left[node] = loads[node] - force; });
    });
    auto& coarser = fields.coarser.front();
    for_rows(
        coarser.load.size(),
        [&](std::size_t aggregate) {
            Node sum{};
            for (const std::int32_t member : finest_.members.of(aggregate)) {
                const Node& force = left[at(member)];
                const Arm<Real, width> arm(finest_.arm[at(member)].data());
                sum = sum + Node::of(force.u(), force.q() + arm.cross(force.u()));
            }
            coarser.load[aggregate] = coarse(sum);
        },
        worth_threads);
    cycle(fields.coarser, 0);
    std::vector<Node>& rigid = left;
    for_rows(
        rigid.size(),
        [&](std::size_t node) {
            const Node motion = fine<width>(coarser.solution[at(finest_.aggregate[node])]);
            const Arm<Real, width> arm(finest_.arm[node].data());
            rigid[node] = Node::of(motion.u() - arm.cross(motion.q()), motion.q());
        },
        worth_threads);
    const Real weight = static_cast<Real>(damping);
    for_chunks(springs.chunks(), [&](std::size_t chunk) {
        springs.template for_forces<width, Which::active>(chunk, rigid, [&](std::size_t node, const Node& force) {
            solution[node] = solution[node] + (rigid[node] - weight * (finest_.inverse_diagonal[node] * force));
        });
    });
    step(loads, solution, turns, 0.0, smoother[0].gain);
    std::swap(solution, turns);
    smooth_on();
}

template <typename Real>
template <int lanes>
void BasicMultigrid<Real>::smooth(const Level& level, Fields<lanes>& fields, bool from_zero) const {
    std::vector<Values<Real, lanes>>&loads = fields.load, &x = fields.solution, &last = fields.step;
    bool first = true;  // whatever stands in the step is not from this iteration
    for (const ChebyshevStep& step : chebyshev_steps(coarse_smoothing, level.max_eigenvalue)) {
        const Real memory = static_cast<Real>(step.memory), gain = static_cast<Real>(step.gain);
        const auto change_at = [&](std::size_t i) {
            if (first && from_zero) return Values<Real, lanes>(gain * block_product(level.inverse_diagonal[i], loads[i]));
            const Values<Real, lanes> rest = loads[i] - row_of_product(level.matrix, i, x);
            return Values<Real, lanes>(gain * block_product(level.inverse_diagonal[i], rest));
        };
        for_rows(
            level.nodes,
            [&](std::size_t i) {
                if (first)
                    last[i] = change_at(i);
                else
                    last[i] = memory * last[i] + change_at(i);
            },
            worth_threads);
        for_rows(
            level.nodes,
            [&](std::size_t i) {
                if (first && from_zero)
                    x[i] = last[i];
                else
                    x[i] += last[i];
            },
            worth_threads);
        first = false;
    }
}

/// Load and solution of all nodes.
template <typename Real>
template <int lanes, typename Load, typename Solution>
void BasicMultigrid<Real>::solve_coarsest(const Load& load, Solution& solution) const {
    const auto values_at = [](const auto& node) {
        if constexpr (std::is_same_v<std::decay_t<decltype(node)>, Values<Real, lanes>>)
            return node.template cast<double>().eval();
        else
            return values_of(node);
    };
    Eigen::MatrixXd unknowns(6 * static_cast<Eigen::Index>(load.size()), lanes);
    for (std::size_t node = 0; node < load.size(); ++node)
        unknowns.middleRows<6>(6 * static_cast<Eigen::Index>(node)) = values_at(load[node]);
    unknowns = coarsest_.solve(unknowns).eval();
    for (std::size_t node = 0; node < load.size(); ++node) {
        const Values<double, lanes> values = unknowns.middleRows<6>(6 * static_cast<Eigen::Index>(node));
        if constexpr (std::is_same_v<typename Solution::value_type, Values<Real, lanes>>)
            solution[node] = values.template cast<Real>();
        else
            solution[node] = motion_of<Real, lanes>(values);
    }
}

template <typename Real>
template <int lanes>
void BasicMultigrid<Real>::cycle(std::vector<Fields<lanes>>& fields, std::size_t index) const {
    Fields<lanes>& here = fields[index];
    if (index + 1 == levels_.size()) return solve_coarsest<lanes>(here.load, here.solution);
    const Level& level = levels_[index];
    Fields<lanes>& coarser = fields[index + 1];
    smooth(level, here, true);
    for_rows(
        level.nodes, [&](std::size_t i) { here.step[i] = here.load[i] - row_of_product(level.matrix, i, here.solution); },
        worth_threads);
    for_rows(
        coarser.load.size(),
        [&](std::size_t a) {
            const auto entries = level.restriction.of(a);
            coarser.load[a] = sum_of_terms<Real, lanes, true>(std::ssize(entries), [&](std::int64_t k) {
                const auto [row, block] = entries[at(k)];
                return Term<Real, lanes>{&level.prolongation.block[at(block)], &here.step[at(row)]};
            });
        },
        worth_threads);
    cycle(fields, index + 1);
    for_rows(
        level.nodes, [&](std::size_t i) { here.solution[i] += row_of_product(level.prolongation, i, coarser.solution); },
        worth_threads);
    smooth(level, here, false);
}

template <typename Real>
template <int width>
typename BasicMultigrid<Real>::template AllFields<width>& BasicMultigrid<Real>::fields() {
    constexpr int lanes = AllFields<width>::lanes;
    AllFields<width>& all = std::get<AllFields<width>>(fields_);
    while (all.coarser.size() < levels_.size()) {
        const std::vector<Values<Real, lanes>> zero(levels_[all.coarser.size()].nodes, Values<Real, lanes>::Zero());
        all.coarser.push_back({zero, zero, zero});
    }
    return all;
}

/// Fields go to the levels with a norm of one, whatever their unit.
template <typename Real>
template <int width>
typename BasicMultigrid<Real>::template Response<width> BasicMultigrid<Real>::apply(const Batch<width>& r,
                                                                                    const PerField<width>& size) {
    AllFields<width>& all = fields<width>();
    const PerField<width> inwards = (size > 0.0).select(size.inverse(), 0.0);
    for (auto* field : {&all.finest.load, &all.finest.solution, &all.finest.other, &all.finest.rest}) field->resize(r.size());
    for_rows(
        r.size(),
        [&](std::size_t i) {
            all.finest.load[i] = motion_of<Real, width>(Values<double, width>(r[i] * inwards.matrix().asDiagonal()));
        },
        worth_threads);
    cycle<width>(all);
    return {all.finest.solution, scale_ * size};
}

template class BasicMultigrid<float>;
template BasicMultigrid<float>::Response<1> BasicMultigrid<float>::apply(const Batch<1>&, const PerField<1>&);
template BasicMultigrid<float>::Response<3> BasicMultigrid<float>::apply(const Batch<3>&, const PerField<3>&);
template class BasicMultigrid<double>;  // shows what is the method's and what is rounding
template BasicMultigrid<double>::Response<1> BasicMultigrid<double>::apply(const Batch<1>&, const PerField<1>&);
template BasicMultigrid<double>::Response<3> BasicMultigrid<double>::apply(const Batch<3>&, const PerField<3>&);

}  // namespace kiln::linalg
