// force_balance.h: how far the forces of a packing are from balance, judged apart from any solver.
#pragma once

#include <span>
#include <vector>

#include "sintering/contact_network.h"
#include "sintering/rigid_clusters.h"

namespace kiln::sintering {

/// The largest force left on any particle, or on any cluster of the coarse spaces, over what the contacts of that particle, or the
/// contacts of that cluster with others, exert if all add up. exerted: size of each pair's force; left: what is left on each
/// particle, in the same unit. A particle on which next to nothing acts is held against a millionth of what acts on one in the
/// mean.
double max_imbalance(const ContactNetwork& network, std::span<const Pair> pairs, std::span<const double> exerted,
                     std::span<const RigidClusters> coarse, const Motion& left);

/// Particles on which more than `limit` of what their contacts exert is left.
std::vector<std::size_t> unbalanced_particles(const ContactNetwork& network, std::span<const double> exerted, double limit,
                                              const Motion& left);

}  // namespace kiln::sintering
