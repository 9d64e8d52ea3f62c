// force_balance.cpp: sums of forces on particles and clusters.
#include "sintering/force_balance.h"

#include <algorithm>
#include <vector>

namespace kiln::sintering {

namespace {

constexpr double negligible = 1e-6;  // of the mean over the particles

double worst_of(const Motion& left, std::span<const double> scale, double least) {
    double worst = 0.0;
    for (std::size_t row = 0; row < scale.size(); ++row)
        worst = std::max(worst, Eigen::Map<const Vec3>(&left.displacement[3 * row]).norm() / std::max(scale[row], least));
    return worst;
}

}  // namespace

double max_imbalance(std::span<const Pair> pairs, std::span<const double> exerted, std::span<const RigidClusters> coarse,
                     const Motion& left) {
    const std::size_t particles = left.displacement.size() / 3;
    std::vector<double> scale(particles, 0.0);
    double sum = 0.0;
    for (std::size_t row = 0; row < pairs.size(); ++row) {
        scale[static_cast<std::size_t>(pairs[row].i)] += exerted[row];
        scale[static_cast<std::size_t>(pairs[row].j)] += exerted[row];
        sum += 2.0 * exerted[row];
    }
    if (!(sum > 0.0)) return 0.0;
    const double least = negligible * sum / static_cast<double>(particles);
    double worst = worst_of(left, scale, least);
    for (const RigidClusters& clusters : coarse) {
        scale.assign(clusters.nodes(), 0.0);
        for (const RigidClusters::NodePair& pair : clusters.node_pairs(pairs)) {
            if (pair.pair.i == pair.pair.j) continue;
            scale[static_cast<std::size_t>(pair.pair.i)] += exerted[pair.row];
            scale[static_cast<std::size_t>(pair.pair.j)] += exerted[pair.row];
        }
        worst = std::max(worst, worst_of(clusters.node_forces(left), scale, least));
    }
    return worst;
}

}  // namespace kiln::sintering
