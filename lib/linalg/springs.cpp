// springs.cpp: springs sorted into chunks of nodes, and products with them.
#include "linalg/springs.h"

#include <Eigen/Geometry>

#include "core/grouping.h"
#include "core/parallel.h"

namespace kiln::linalg {

namespace {

using Mat3 = Eigen::Matrix3d;

/// The same spring with its nodes in ascending order.
template <typename Real>
Spring<Real> ascending(const Spring<Real>& spring) {
    if (spring.first <= spring.second) return spring;
    return {spring.second, spring.first, {-spring.arm[0], -spring.arm[1], -spring.arm[2]}, spring.shear, spring.axial,
            spring.bending, spring.twisting};
}

std::size_t at(std::int32_t index) { return static_cast<std::size_t>(index); }

/// Moves the idle ones to the end of a run, otherwise in the same order.
template <typename Run, typename From, typename Idle, typename Move>
Run split(const From& run, const Idle& idle, const Move& move) {
    std::size_t to = run.first;
    for (std::size_t k = run.first; k < run.last; ++k)
        if (!idle(k)) move(k, to++);
    const std::size_t middle = to;
    for (std::size_t k = run.first; k < run.last; ++k)
        if (idle(k)) move(k, to++);
    return {run.first, middle, run.last};
}

}  // namespace

SpringBlocks blocks_of(const Spring<double>& spring) {
    const Eigen::Map<const Vec3> arm(spring.arm);
    const Mat3 along = arm * arm.transpose();
    const Mat3 C = spring.shear * Mat3::Identity() + spring.axial * along;
    const Mat3 rotation = spring.bending * Mat3::Identity() + spring.twisting * along;
    Mat3 S;
    S << 0.0, -arm[2], arm[1], arm[2], 0.0, -arm[0], -arm[1], arm[0], 0.0;
    const Mat3 CS = C * S, SCS = S.transpose() * CS;
    SpringBlocks blocks;
    blocks.ii << C, -CS, -CS.transpose(), SCS + rotation;
    blocks.jj << C, CS, CS.transpose(), SCS + rotation;
    blocks.ij << -C, -CS, CS.transpose(), SCS - rotation;
    return blocks;
}

template <typename Real>
Springs<Real>::Springs(std::size_t nodes, const std::vector<Spring<Real>>& springs)
    : nodes_(nodes), springs_(springs.size()), place_(springs.size()) {
    const std::size_t count = (nodes + nodes_in_chunk - 1) / nodes_in_chunk;
    const auto chunk_of = [](std::int32_t node) { return at(node) / nodes_in_chunk; };
    const Grouping<std::uint32_t> by_first = group_by<std::uint32_t>(nodes, [&](const auto& visit) {
        for (std::size_t row = 0; row < springs.size(); ++row)
            visit(at(std::min(springs[row].first, springs[row].second)), static_cast<std::uint32_t>(row));
    });
    for (std::size_t k = 0; k < springs.size(); ++k) {
        springs_[k] = ascending(springs[by_first.items[k]]);
        place_[by_first.items[k]] = static_cast<std::uint32_t>(k);
    }
    Grouping<std::uint32_t> incoming = group_by<std::uint32_t>(count, [&](const auto& visit) {
        for (std::size_t k = 0; k < springs_.size(); ++k)
            if (chunk_of(springs_[k].first) != chunk_of(springs_[k].second))
                visit(chunk_of(springs_[k].second), static_cast<std::uint32_t>(k));
    });
    for (std::size_t chunk = 0; chunk < count; ++chunk) {
        const std::size_t first = chunk * nodes_in_chunk, last = std::min(nodes, first + nodes_in_chunk);
        const std::size_t own = by_first.begin[last], others = incoming.begin[chunk + 1];
        chunks_.push_back({first, last, {by_first.begin[first], own, own}, {incoming.begin[chunk], others, others}});
    }
    incoming_ = std::move(incoming.items);
}

template <typename Real>
Springs<Real>::Springs(const Springs<double>& other, double factor, const std::function<bool(const Spring<double>&)>& idle)
    : nodes_(other.nodes_), springs_(other.springs_.size()), incoming_(other.incoming_.size()), held_(other.held_) {
    std::vector<std::uint32_t> place(springs_.size());
    for (const auto& c : other.chunks_) {
        Chunk& here = chunks_.emplace_back(Chunk{c.first_node, c.last_node, {}, {}});
        here.own = split<Run>(c.own, [&](std::size_t k) { return idle(other.springs_[k]); },
                         [&](std::size_t from, std::size_t to) { place[from] = static_cast<std::uint32_t>(to); });
        here.incoming = split<Run>(c.incoming, [&](std::size_t k) { return idle(other.springs_[other.incoming_[k]]); },
                              [&](std::size_t from, std::size_t to) { incoming_[to] = other.incoming_[from]; });
    }
    for_rows(incoming_.size(), [&](std::size_t k) { incoming_[k] = place[incoming_[k]]; }, worth_threads);
    for_rows(springs_.size(), [&](std::size_t k) {
        const Spring<double>& from = other.springs_[k];
        const auto arm = [&](int axis) { return static_cast<Real>(from.arm[axis]); };
        const auto scaled = [&](double stiffness) { return static_cast<Real>(factor * stiffness); };
        springs_[place[k]] = {from.first,          from.second,        {arm(0), arm(1), arm(2)},
                              scaled(from.shear), scaled(from.axial), scaled(from.bending), scaled(from.twisting)};
    });
    for (auto& [node, stiffness] : held_) stiffness *= factor;
}

template <typename Real>
void Springs<Real>::soften(std::size_t row, double share) {
    Spring<Real>& spring = springs_[place_[row]];
    for (Real* stiffness : {&spring.shear, &spring.axial, &spring.bending, &spring.twisting})
        *stiffness = static_cast<Real>(share * static_cast<double>(*stiffness));
}

template class Springs<float>;
template class Springs<double>;

void multiply(const Springs<double>& matrix, const Vector& x, Vector& y) {
    y.resize(matrix.nodes());
    std::vector<Freedoms<double, 1>> motions(x.size());  // as registers take them
    for_rows(x.size(), [&](std::size_t node) { motions[node] = motion_of<double, 1>(x[node]); }, worth_threads);
    for_chunks(matrix.chunks(), [&](std::size_t chunk) {
        matrix.for_forces<1>(chunk, motions,
                             [&](std::size_t node, const Freedoms<double, 1>& force) { y[node] = values_of(force); });
    });
}

template <int width>
void residual(const Springs<double>& matrix, const Batch<width>& x, const Batch<width>& b, Batch<width>& r) {
    r.resize(matrix.nodes());
    for_chunks(matrix.chunks(), [&](std::size_t chunk) {
        matrix.for_forces<width>(chunk, x, [&](std::size_t node, const Freedoms<double, width>& force) {
            r[node] = b[node] - values_of(force);
        });
    });
}

template void residual<1>(const Springs<double>&, const Batch<1>&, const Batch<1>&, Batch<1>&);
template void residual<3>(const Springs<double>&, const Batch<3>&, const Batch<3>&, Batch<3>&);

std::vector<Mat6> diagonal_blocks(const Springs<double>& matrix) {
    std::vector<Mat6> diagonal(matrix.nodes(), Mat6::Zero());
    for_chunks(matrix.chunks(), [&](std::size_t chunk) {
        const auto [first, last] = matrix.nodes_of(chunk);
        const auto own = [&](std::int32_t node) { return at(node) >= first && at(node) < last; };
        matrix.for_springs(chunk, [&](const Spring<double>& spring) {
            const SpringBlocks blocks = blocks_of(spring);
            if (own(spring.first)) diagonal[at(spring.first)] += blocks.ii;
            if (own(spring.second)) diagonal[at(spring.second)] += blocks.jj;
            if (spring.first == spring.second) diagonal[at(spring.first)] += blocks.ij + blocks.ij.transpose();
        });
    });
    for (const auto& [node, stiffness] : matrix.held()) diagonal[node].diagonal() += stiffness;
    return diagonal;
}

}  // namespace kiln::linalg
