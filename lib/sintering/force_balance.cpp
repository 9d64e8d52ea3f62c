// force_balance.cpp: sums of forces on particles and clusters.
#include "sintering/force_balance.h"

#include <algorithm>
#include <vector>

namespace kiln::sintering {

namespace {

constexpr double negligible = 1e-6;  // of the mean over the particles

double size_of(const Motion& left, std::size_t row) { return Eigen::Map<const Vec3>(&left.displacement[3 * row]).norm(); }

double worst_of(const Motion& left, std::span<const double> scale, double least) {
    return greatest_of_rows(scale.size(), 0.0,
                            [&](std::size_t row) { return size_of(left, row) / std::max(scale[row], least); });
}

/// What the contacts of each particle exert if all add up.
struct Exerted {
    std::vector<double> on;  // particle
    double sum = 0.0;

    double least() const { return negligible * sum / static_cast<double>(on.size()); }
};

Exerted exerted_on_particles(const ContactNetwork& network, std::span<const double> exerted) {
    Exerted result{std::vector<double>(network.particles(), 0.0)};
    std::vector<double>& scale = result.on;
    result.sum = network.sum_chunks(0.0, [&](std::size_t index) {
        const ContactNetwork::Chunk& chunk = network.chunks()[index];
        for (std::size_t entry = chunk.begin; entry < chunk.end; ++entry)
            for (const std::int32_t particle : {network.first[entry], network.second[entry]}) {
                const auto row = static_cast<std::size_t>(particle);
                if (row >= chunk.first_particle && row < chunk.last_particle)
                    scale[row] += exerted[static_cast<std::size_t>(network.pair[entry])];
            }
        double part = 0.0;
        for (std::size_t row = chunk.first_particle; row < chunk.last_particle; ++row) part += scale[row];
        return part;
    });
    return result;
}

}  // namespace

double max_imbalance(const ContactNetwork& network, std::span<const Pair> pairs, std::span<const double> exerted,
                     std::span<const RigidClusters> coarse, const Motion& left) {
    const Exerted particles = exerted_on_particles(network, exerted);
    if (!(particles.sum > 0.0)) return 0.0;
    const double least = particles.least();
    double worst = worst_of(left, particles.on, least);
    for (const RigidClusters& clusters : coarse) {
        std::vector<double> scale(clusters.nodes(), 0.0);
        for (const RigidClusters::NodePair& pair : clusters.node_pairs(pairs)) {
            if (pair.pair.i == pair.pair.j) continue;
            scale[static_cast<std::size_t>(pair.pair.i)] += exerted[pair.row];
            scale[static_cast<std::size_t>(pair.pair.j)] += exerted[pair.row];
        }
        worst = std::max(worst, worst_of(clusters.node_forces(left), scale, least));
    }
    return worst;
}

std::vector<std::size_t> unbalanced_particles(const ContactNetwork& network, std::span<const double> exerted, double limit,
                                              const Motion& left) {
    const Exerted particles = exerted_on_particles(network, exerted);
    const double least = particles.least();
    std::vector<std::size_t> unbalanced;
    for (std::size_t row = 0; row < particles.on.size(); ++row)
        if (size_of(left, row) > limit * std::max(particles.on[row], least)) unbalanced.push_back(row);
    return unbalanced;
}

}  // namespace kiln::sintering
