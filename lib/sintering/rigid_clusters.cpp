// rigid_clusters.cpp: union of sticking particles, and pairs and motions seen from their nodes.
#include "sintering/rigid_clusters.h"

#include <algorithm>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "physics/sinter_contact.h"

namespace kiln::sintering {

namespace {

constexpr std::int32_t large_cluster = 16;  // members

constexpr double sticking_gap = 1e-6;  // of the reduced radius, between rigid particles that touch

Vec3 shift_of(const Box& box, const PeriodicClusters::Offset& image) {
    return {image[0] * box.lengths[0], image[1] * box.lengths[1], image[2] * box.lengths[2]};
}

}  // namespace

bool sticks(const SinteringBody& packing, const Kinetics& kinetics, const Pair& pair) {
    if (!kinetics.any_rigid() || !kinetics.rigid(kinetics.row(packing.particles(), pair))) return false;
    const auto [first, second] = packing.radii(pair);
    return packing.vector(pair).norm() - first - second - packing.offset(pair) <
           sticking_gap * physics::reduced_radius(first, second);
}

RigidClusters::RigidClusters(const Box& box, std::span<const Vec3> position, std::span<const Pair> sticking)
    : box_(box), single_(sticking.empty()), place_(position.begin(), position.end()) {
    if (single_) return;
    PeriodicClusters clusters(position.size());
    for (const Pair& pair : sticking) clusters.join(pair);
    locked_ = clusters.percolating();
    const std::size_t count = position.size();
    std::vector<std::int32_t> root(count), members(count, 0), first(count, -1);  // the last two of each root
    std::vector<PeriodicClusters::Offset> image(count);                          // as seen from the root
    for (std::size_t row = 0; row < count; ++row) {
        root[row] = clusters.root(static_cast<std::int32_t>(row), image[row]);
        ++members[static_cast<std::size_t>(root[row])];
        std::int32_t& member = first[static_cast<std::size_t>(root[row])];
        if (member < 0) member = static_cast<std::int32_t>(row);
    }
    for (std::size_t row = 0; row < count; ++row)
        if (first[static_cast<std::size_t>(root[row])] == static_cast<std::int32_t>(row))
            first_.push_back(static_cast<std::int32_t>(row));
    const auto size_of = [&](std::int32_t row) {
        const std::int32_t size = members[static_cast<std::size_t>(root[static_cast<std::size_t>(row)])];
        return size < large_cluster ? 0 : size;
    };
    std::ranges::stable_sort(first_, {}, size_of);
    place_.clear();
    std::vector<std::int32_t> node_of_root(count);
    for (const std::int32_t row : first_) {
        node_of_root[static_cast<std::size_t>(root[static_cast<std::size_t>(row)])] = static_cast<std::int32_t>(place_.size());
        place_.push_back(position[static_cast<std::size_t>(row)]);
    }
    node_.resize(count);
    offset_.resize(count);
    arm_.resize(count);
    for (std::size_t row = 0; row < count; ++row) {
        node_[row] = node_of_root[static_cast<std::size_t>(root[row])];
        const auto node = static_cast<std::size_t>(node_[row]);
        for (std::size_t axis = 0; axis < 3; ++axis)
            offset_[row][axis] = image[row][axis] - image[static_cast<std::size_t>(first_[node])][axis];
        arm_[row] = place_[node] - (position[row] + shift_of(box_, offset_[row]));
    }
}

RigidClusters::NodePair RigidClusters::node_pair(const Pair& pair, std::size_t row) const {
    const auto i = static_cast<std::size_t>(pair.i), j = static_cast<std::size_t>(pair.j);
    NodePair seen{{node_[i], node_[j], {}}, row, node_[i] > node_[j]};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const int image = pair.image[axis] + offset_[i][axis] - offset_[j][axis];
        if (image < -127 || image > 127) throw Error("a rigid cluster winds around the box more than a hundred times");
        seen.pair.image[axis] = static_cast<std::int8_t>(seen.reversed ? -image : image);
    }
    if (seen.reversed) std::swap(seen.pair.i, seen.pair.j);
    return seen;
}

std::vector<RigidClusters::NodePair> RigidClusters::node_pairs(std::span<const Pair> pairs) const {
    std::vector<NodePair> seen;
    for (std::size_t row = 0; row < pairs.size(); ++row) {
        const NodePair one = single_ ? NodePair{pairs[row], row, false} : node_pair(pairs[row], row);
        if (one.pair.i != one.pair.j || one.pair.image != Image{0, 0, 0}) seen.push_back(one);
    }
    const auto place = [](const NodePair& one) { return std::tie(one.pair.i, one.pair.j, one.pair.image, one.row); };
    if (!single_) std::ranges::sort(seen, [&](const NodePair& a, const NodePair& b) { return place(a) < place(b); });
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

Motion RigidClusters::node_forces(const Motion& forces) const {
    if (single_) return forces;
    Motion sums(place_.size());
    sums.strain = forces.strain;
    for (std::size_t row = 0; row < node_.size(); ++row) {
        const Eigen::Map<const Vec3> force(&forces.displacement[3 * row]);
        Eigen::Map<Vec3>(&sums.displacement[3 * static_cast<std::size_t>(node_[row])]) += force;
        sums.strain += force.cwiseProduct(arm_[row]);
    }
    return sums;
}

Motion RigidClusters::particles(const Motion& nodes) const {
    if (single_) return nodes;
    Motion motion(node_.size());
    motion.strain = nodes.strain;
    for (std::size_t row = 0; row < node_.size(); ++row)
        Eigen::Map<Vec3>(&motion.displacement[3 * row]) =
            Eigen::Map<const Vec3>(&nodes.displacement[3 * static_cast<std::size_t>(node_[row])]) +
            nodes.strain.cwiseProduct(arm_[row]);
    return motion;
}

std::vector<RigidClusters> coarse_spaces(const Box& box, std::span<const Vec3> position, std::span<const Pair> pairs,
                                         std::span<const double> slowness, double contrast) {
    std::vector<RigidClusters> spaces;
    double last = 1.0;
    for (const double present : std::set<double>(slowness.begin(), slowness.end())) {
        if (present < contrast * last) continue;
        last = present;
        std::vector<Pair> tied;
        for (std::size_t row = 0; row < pairs.size(); ++row)
            if (slowness[row] >= present) tied.push_back(pairs[row]);
        spaces.emplace_back(box, position, tied);
    }
    return spaces;
}

}  // namespace kiln::sintering
