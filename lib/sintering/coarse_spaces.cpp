// coarse_spaces.cpp: factorisations of the networks of clusters, and how a residual passes down to them and back.
#include "sintering/coarse_spaces.h"

#include <algorithm>

namespace kiln::sintering {

namespace {

std::vector<Pair> pairs_of(const std::vector<RigidClusters::NodePair>& rows) {
    std::vector<Pair> pairs;
    pairs.reserve(rows.size());
    for (const RigidClusters::NodePair& row : rows) pairs.push_back(row.pair);
    return pairs;
}

}  // namespace

template <typename Real>
CoarseSpaces<Real>::Level::Level(const Box& box, const RigidClusters& seen, const std::vector<RigidClusters::NodePair>& rows,
                                 const std::vector<Pair>& pairs, const std::vector<std::size_t>& entry_of_row)
    : clusters(seen), network(box, seen.places(), pairs), stiffness(network), r(seen.nodes()), z(seen.nodes()) {
    for (const RigidClusters::NodePair& row : rows) {
        entry.push_back(entry_of_row[row.row]);
        branch.push_back(pair_vector(box, seen.places(), row.pair));
    }
}

template <typename Real>
CoarseSpaces<Real>::CoarseSpaces(const Box& box, const ContactNetwork& network, std::span<const Pair> pairs,
                                 std::span<const RigidClusters> coarse) {
    if (coarse.empty()) return;
    std::vector<std::size_t> entry_of_row(pairs.size());
    for (std::size_t entry = 0; entry < network.pair.size(); ++entry)
        entry_of_row[static_cast<std::size_t>(network.pair[entry])] = entry;
    for (const RigidClusters& clusters : coarse) {
        const std::vector<RigidClusters::NodePair> rows = clusters.node_pairs(pairs);
        levels_.push_back(std::make_unique<Level>(box, clusters, rows, pairs_of(rows), entry_of_row));
    }
}

template <typename Real>
void CoarseSpaces<Real>::factorise(const linalg::EdgeStiffness<Real>& springs) {
    for (const auto& level : levels_) {
        for_rows(level->network.pair.size(), [&](std::size_t entry) {
            level->stiffness.springs().copy(entry, springs, level->entry[static_cast<std::size_t>(level->network.pair[entry])]);
        });
        level->stiffness.assemble(level->branch);
    }
}

template <typename Real>
void CoarseSpaces<Real>::apply(const Eigen::Matrix3d& allowed, const QuadMotion<Real>& r, QuadMotion<Real>& z) {
    std::fill(z.displacement.begin(), z.displacement.end(), Quad<Real>{});
    z.strain.setZero();
    for (const auto& level : levels_) {
        const std::span<const std::int32_t> node_of = level->clusters.node_of();
        const std::span<const Vec3> arms = level->clusters.arms();
        std::fill(level->r.displacement.begin(), level->r.displacement.end(), Quad<Real>{});
        level->r.strain = r.strain;
        for (std::size_t row = 0; row < node_of.size(); ++row) {
            level->r.displacement[static_cast<std::size_t>(node_of[row])] += r.displacement[row];
            level->r.strain += linalg::vector(r.displacement[row]).cwiseProduct(arms[row]);
        }
        level->network.for_chunks([&](std::size_t index) {
            level->stiffness.factor().apply(level->stiffness.range(index), level->r.displacement.data(),
                                            level->z.displacement.data());
        });
        level->z.strain = allowed * (level->stiffness.strain_inverse() * (allowed * level->r.strain));
        z.strain += level->z.strain;
        for (std::size_t row = 0; row < node_of.size(); ++row)
            z.displacement[row] += level->z.displacement[static_cast<std::size_t>(node_of[row])] +
                                   linalg::quad<Real>(Vec3(level->z.strain.cwiseProduct(arms[row])));
    }
}

template class CoarseSpaces<float>;
template class CoarseSpaces<double>;

}  // namespace kiln::sintering
