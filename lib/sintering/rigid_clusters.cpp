// rigid_clusters.cpp: union of sticking particles, and pairs and motions seen from their nodes.
#include "sintering/rigid_clusters.h"

#include <string>
#include <utility>

#include "physics/sinter_contact.h"

namespace kiln::sintering {

namespace {

constexpr double sticking_gap = 1e-6;  // of the reduced radius, between rigid particles that touch

Vec3 shift_of(const Box& box, const PeriodicClusters::Offset& image) {
    return {image[0] * box.lengths[0], image[1] * box.lengths[1], image[2] * box.lengths[2]};
}

}  // namespace

bool sticks(const SinteringBody& packing, const Kinetics& kinetics, const Pair& pair) {
    if (!kinetics.any_rigid() || !kinetics.rigid(kinetics.row(packing.particles(), pair))) return false;
    const auto [first, second] = packing.radii(pair);
    return packing.vector(pair).norm() - first - second < sticking_gap * physics::reduced_radius(first, second);
}

RigidClusters::RigidClusters(const Box& box, std::span<const Vec3> position, std::span<const Pair> sticking)
    : box_(box), single_(sticking.empty()), place_(position.begin(), position.end()) {
    if (single_) return;
    PeriodicClusters clusters(position.size());
    for (const Pair& pair : sticking) clusters.join(pair);
    locked_ = clusters.percolating();
    place_.clear();
    node_.resize(position.size());
    offset_.resize(position.size());
    std::vector<std::int32_t> node_of_root(position.size(), -1);
    std::vector<PeriodicClusters::Offset> first_offset;  // of the particle that a node is named for, seen from the root
    for (std::size_t row = 0; row < position.size(); ++row) {
        PeriodicClusters::Offset image{};
        const auto root = static_cast<std::size_t>(clusters.root(static_cast<std::int32_t>(row), image));
        if (node_of_root[root] < 0) {
            node_of_root[root] = static_cast<std::int32_t>(place_.size());
            place_.push_back(position[row]);
            first_.push_back(static_cast<std::int32_t>(row));
            first_offset.push_back(image);
        }
        node_[row] = node_of_root[root];
        for (std::size_t axis = 0; axis < 3; ++axis)
            offset_[row][axis] = image[axis] - first_offset[static_cast<std::size_t>(node_[row])][axis];
    }
}

Pair RigidClusters::seen(const Pair& pair, bool& turned) const {
    turned = false;
    if (single_) return pair;
    const auto i = static_cast<std::size_t>(pair.i), j = static_cast<std::size_t>(pair.j);
    Pair seen{node_[i], node_[j], {}};
    turned = seen.i > seen.j;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const int image = pair.image[axis] + offset_[i][axis] - offset_[j][axis];
        if (image < -127 || image > 127) throw Error("a rigid cluster winds around the box more than a hundred times");
        seen.image[axis] = static_cast<std::int8_t>(turned ? -image : image);
    }
    if (turned) std::swap(seen.i, seen.j);
    return seen;
}

Motion RigidClusters::nodes(const Motion& particles) const {
    if (single_) return particles;
    Motion motion(place_.size());
    motion.strain = particles.strain;
    for (std::size_t node = 0; node < place_.size(); ++node)
        for (std::size_t axis = 0; axis < 3; ++axis)
            motion.displacement[3 * node + axis] = particles.displacement[3 * static_cast<std::size_t>(first_[node]) + axis];
    return motion;
}

Motion RigidClusters::particles(const Motion& nodes, std::span<const Vec3> position) const {
    if (single_) return nodes;
    Motion motion(position.size());
    motion.strain = nodes.strain;
    for (std::size_t row = 0; row < position.size(); ++row) {
        const auto node = static_cast<std::size_t>(node_[row]);
        const Vec3 arm = place_[node] - (position[row] + shift_of(box_, offset_[row]));  // from the particle to its node
        Eigen::Map<Vec3>(&motion.displacement[3 * row]) =
            Eigen::Map<const Vec3>(&nodes.displacement[3 * node]) + nodes.strain.cwiseProduct(arm);
    }
    return motion;
}

}  // namespace kiln::sintering
