// rigid_clusters.h: particles that stick to each other move as one node of the contact network.
#pragma once

#include <span>
#include <vector>

#include "core/contacts.h"
#include "sintering/kinetics.h"
#include "sintering/sintering_body.h"

namespace kiln::sintering {

/// True for a pair that does not diffuse and touches, to a millionth of its reduced radius: it moves as one.
bool sticks(const SinteringBody& packing, const Kinetics& kinetics, const Pair& pair);

/// The nodes that a step moves: particles, or clusters of particles whose contacts do not diffuse (rigid inclusions). A cluster
/// translates as a whole, since no contact of the model passes a moment, and takes no part in the strain of the box.
class RigidClusters {
   public:
    /// Without pairs that stick every particle is its own node.
    RigidClusters(const Box& box, std::span<const Vec3> position, std::span<const Pair> sticking);

    std::size_t nodes() const { return place_.size(); }
    const std::vector<Vec3>& places() const { return place_; }  // m, of each node: that of its first particle

    /// Node of each particle, and the vector from the particle to the node's place, m; none without pairs that stick. Large
    /// clusters, which have many neighbours, are the last nodes: an incomplete factorisation is best where they come last.
    std::span<const std::int32_t> node_of() const { return node_; }
    std::span<const Vec3> arms() const { return arm_; }

    /// A pair of particles as the nodes see it.
    struct NodePair {
        Pair pair;        // of nodes
        std::size_t row;  // of the pair of particles
        bool reversed;    // its first node comes second
    };

    /// The pairs of nodes, sorted; without those whose particles move together however the box strains.
    std::vector<NodePair> node_pairs(std::span<const Pair> pairs) const;

    /// Axes along which a rigid cluster reaches its own image, so that the box cannot strain.
    const std::array<bool, 3>& locked() const { return locked_; }

    /// Motion of the nodes that particles with this motion would give them.
    Motion nodes(const Motion& particles) const;

    /// Forces on the nodes, and the work conjugate to the strains, from those on the particles: the transpose of particles().
    Motion node_forces(const Motion& forces) const;

    /// Motion of the particles from that of the nodes.
    Motion particles(const Motion& nodes) const;

   private:
    NodePair node_pair(const Pair& pair, std::size_t row) const;

    Box box_;
    bool single_;                     // every particle is a node
    std::vector<std::int32_t> node_;  // of each particle
    std::vector<PeriodicClusters::Offset> offset_;  // image by which the particle is seen from its node
    std::vector<std::int32_t> first_;  // particle that stands for each node
    std::vector<Vec3> place_, arm_;
    std::array<bool, 3> locked_{false, false, false};
};

/// Clusters of the particles that slow contacts tie together, one set for each step in the contrast of the contacts: what a
/// preconditioner needs to see of a network of soft and stiff contacts. slowness: diffusion of the fastest pair over that of each
/// pair, zero for one that ties nothing. A slowness begins a set where it is `contrast` times that of the set before.
std::vector<RigidClusters> coarse_spaces(const Box& box, std::span<const Vec3> position, std::span<const Pair> pairs,
                                         std::span<const double> slowness, double contrast);

}  // namespace kiln::sintering
