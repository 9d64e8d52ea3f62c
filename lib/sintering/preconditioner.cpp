// preconditioner.cpp: factorisations of the network and of its clusters, and how a residual passes down to them and back.
#include "sintering/preconditioner.h"

namespace kiln::sintering {

namespace {

constexpr double min_strain_pivot = 1e-12;  // of the trace; below it no contact reaches along an axis

std::vector<linalg::NodeRange> ranges_of(const ContactNetwork& network) {
    std::vector<linalg::NodeRange> ranges;
    for (const ContactNetwork::Chunk& chunk : network.chunks())
        ranges.push_back({chunk.first_particle, chunk.last_particle, chunk.begin, chunk.first_only, chunk.end});
    return ranges;
}

/// Inverse of the stiffness against strains of the box while all nodes move with it: the sum of l K l over the contacts, with l the
/// branch vector as a diagonal matrix. block(entry): K.
template <typename Block>
Eigen::Matrix3d strain_inverse_of(const ContactNetwork& network, std::span<const Vec3> branch, const Block& block) {
    std::vector<Eigen::Matrix3d> parts(network.chunks().size(), Eigen::Matrix3d::Zero());
    network.for_chunks([&](std::size_t index) {
        network.for_owned(index, [&](std::size_t entry) {
            const Vec3& l = branch[static_cast<std::size_t>(network.pair[entry])];
            parts[index] += l.asDiagonal() * block(entry) * l.asDiagonal();
        });
    });
    Eigen::Matrix3d strain = Eigen::Matrix3d::Zero();
    for (const Eigen::Matrix3d& part : parts) strain += part;
    return linalg::pivot_inverse(strain, strain, min_strain_pivot).value_or(strain);  // or no number
}

std::vector<Pair> pairs_of(const std::vector<RigidClusters::NodePair>& rows) {
    std::vector<Pair> pairs;
    pairs.reserve(rows.size());
    for (const RigidClusters::NodePair& row : rows) pairs.push_back(row.pair);
    return pairs;
}

}  // namespace

template <typename Real>
Preconditioner<Real>::Coarse::Coarse(const Box& box, const RigidClusters& seen,
                                     const std::vector<RigidClusters::NodePair>& rows, const std::vector<Pair>& pairs,
                                     const std::vector<std::size_t>& entry_of_row)
    : clusters(seen),
      network(box, seen.places(), pairs),
      ranges(ranges_of(network)),
      factor(seen.nodes(), ranges, network.first, network.second),
      r(seen.nodes()),
      z(seen.nodes()) {
    for (const RigidClusters::NodePair& row : rows) {
        entry.push_back(entry_of_row[row.row]);
        branch.push_back(pair_vector(box, seen.places(), row.pair));
    }
}

template <typename Real>
Preconditioner<Real>::Preconditioner(const Box& box, const ContactNetwork& network, std::span<const Pair> pairs,
                                     std::span<const RigidClusters> coarse)
    : network_(network), ranges_(ranges_of(network)), finest_(network.particles(), ranges_, network.first, network.second) {
    if (coarse.empty()) return;
    std::vector<std::size_t> entry_of_row(pairs.size());
    for (std::size_t entry = 0; entry < network.pair.size(); ++entry)
        entry_of_row[static_cast<std::size_t>(network.pair[entry])] = entry;
    for (const RigidClusters& clusters : coarse) {
        const std::vector<RigidClusters::NodePair> rows = clusters.node_pairs(pairs);
        coarse_.push_back(std::make_unique<Coarse>(box, clusters, rows, pairs_of(rows), entry_of_row));
    }
}

template <typename Real>
void Preconditioner<Real>::factorise(const Stiffness<Real>& stiffness, std::span<const Vec3> branch) {
    network_.for_chunks([&](std::size_t index) {
        finest_.factorise(ranges_[index], [&](std::size_t entry) { return stiffness.block(entry); });
    });
    strain_inverse_ = strain_inverse_of(network_, branch, [&](std::size_t entry) { return stiffness.block(entry); });
    for (const auto& level : coarse_) {
        const auto block = [&](std::size_t entry) {
            return stiffness.block(level->entry[static_cast<std::size_t>(level->network.pair[entry])]);
        };
        level->network.for_chunks([&](std::size_t index) { level->factor.factorise(level->ranges[index], block); });
        level->strain_inverse = strain_inverse_of(level->network, level->branch, block);
    }
}

template <typename Real>
void Preconditioner<Real>::add_coarse(const Eigen::Matrix3d& allowed, const QuadMotion<Real>& r, QuadMotion<Real>& z) {
    for (const auto& level : coarse_) {
        const std::span<const std::int32_t> node_of = level->clusters.node_of();
        const std::span<const Vec3> arms = level->clusters.arms();
        std::fill(level->r.displacement.begin(), level->r.displacement.end(), Quad<Real>{});
        level->r.strain = r.strain;
        for (std::size_t row = 0; row < node_of.size(); ++row) {
            level->r.displacement[static_cast<std::size_t>(node_of[row])] += r.displacement[row];
            level->r.strain += linalg::vector(r.displacement[row]).cwiseProduct(arms[row]);
        }
        level->network.for_chunks([&](std::size_t index) {
            level->factor.apply(level->ranges[index], level->r.displacement.data(), level->z.displacement.data());
        });
        level->z.strain = allowed * (level->strain_inverse * (allowed * level->r.strain));
        z.strain += level->z.strain;
        for (std::size_t row = 0; row < node_of.size(); ++row)
            z.displacement[row] += level->z.displacement[static_cast<std::size_t>(node_of[row])] +
                                   linalg::quad<Real>(Vec3(level->z.strain.cwiseProduct(arms[row])));
    }
}

template class Preconditioner<float>;
template class Preconditioner<double>;

}  // namespace kiln::sintering
