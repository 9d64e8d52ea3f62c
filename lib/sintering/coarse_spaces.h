// coarse_spaces.h: coarse spaces that an incomplete factorisation of a contact network is helped by.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "sintering/rigid_clusters.h"
#include "sintering/stiffness.h"

namespace kiln::sintering {

/// Factorisations of the networks of clusters, one for each coarse space.
///
/// An incomplete factorisation takes the soft motions of a group that stiff contacts tie together, its translation and its share
/// in the strain of the box, for as stiff as the contacts in it. As one node of a coarse network the group is held by its soft
/// contacts alone. (Additive Schwarz method with a coarse space; Smith, Bjorstad & Gropp, Domain Decomposition, 1996, chapter 2.)
template <typename Real>
class CoarseSpaces {
   public:
    /// coarse: clusters of each coarse space, to which references are kept.
    CoarseSpaces(const Box& box, const ContactNetwork& network, std::span<const Pair> pairs, std::span<const RigidClusters> coarse);

    bool empty() const { return levels_.empty(); }

    /// Takes the present stiffness of the network.
    void factorise(const linalg::EdgeStiffness<Real>& springs);

    /// z = what all spaces bring to M^-1 r. allowed: projector onto the strains that the box may take.
    void apply(const Eigen::Matrix3d& allowed, const QuadMotion<Real>& r, QuadMotion<Real>& z);

   private:
    struct Level {
        const RigidClusters& clusters;
        std::vector<std::size_t> entry;  // of the finest network, of each pair of nodes
        std::vector<Vec3> branch;        // of each pair of nodes, m
        ContactNetwork network;
        Stiffness<Real> stiffness;
        QuadMotion<Real> r, z;

        Level(const Box& box, const RigidClusters& seen, const std::vector<RigidClusters::NodePair>& rows,
              const std::vector<Pair>& pairs, const std::vector<std::size_t>& entry_of_row);
    };

    std::vector<std::unique_ptr<Level>> levels_;
};

}  // namespace kiln::sintering
