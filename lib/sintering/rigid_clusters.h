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

    /// The pair as the nodes see it; `turned` tells that its first node comes second.
    Pair seen(const Pair& pair, bool& turned) const;

    /// True where both particles move together however the box strains.
    static bool inert(const Pair& seen) { return seen.i == seen.j && seen.image == Image{0, 0, 0}; }

    /// Axes along which a rigid cluster reaches its own image, so that the box cannot strain.
    const std::array<bool, 3>& locked() const { return locked_; }

    /// Motion of the nodes that particles with this motion would give them.
    Motion nodes(const Motion& particles) const;

    /// Motion of the particles from that of the nodes.
    Motion particles(const Motion& nodes, std::span<const Vec3> position) const;

   private:
    Box box_;
    bool single_;                     // every particle is a node
    std::vector<std::int32_t> node_;  // of each particle
    std::vector<PeriodicClusters::Offset> offset_;  // image by which the particle is seen from its node
    std::vector<std::int32_t> first_;  // particle that stands for each node
    std::vector<Vec3> place_;
    std::array<bool, 3> locked_{false, false, false};
};

}  // namespace kiln::sintering
