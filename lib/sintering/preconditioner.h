// preconditioner.h: an approximate inverse of the stiffness of a contact network with the strains of its box.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "linalg/incomplete_cholesky.h"
#include "sintering/rigid_clusters.h"
#include "sintering/stiffness.h"

namespace kiln::sintering {

/// The sum of an incomplete factorisation of the network and, for each coarse space, one of the network of its clusters.
///
/// An incomplete factorisation takes the soft motions of a group that stiff contacts tie together, its translation and its share
/// in the strain of the box, for as stiff as the contacts in it. As one node of a coarse network the group is held by its soft
/// contacts alone. (Additive Schwarz method with a coarse space; Smith, Bjorstad & Gropp, Domain Decomposition, 1996, chapter 2.)
template <typename Real>
class Preconditioner {
   public:
    /// coarse: clusters of each coarse space. Keeps references to the network and to the clusters.
    Preconditioner(const Box& box, const ContactNetwork& network, std::span<const Pair> pairs,
                   std::span<const RigidClusters> coarse = {});

    /// Takes the present stiffness. branch: from node to node of each pair, m.
    void factorise(const Stiffness<Real>& stiffness, std::span<const Vec3> branch);

    bool has_coarse_spaces() const { return !coarse_.empty(); }

    /// z = M^-1 r of the finest network, for the particles of one chunk.
    void apply(std::size_t chunk, const QuadMotion<Real>& r, QuadMotion<Real>& z) const {
        finest_.apply(ranges_[chunk], r.displacement.data(), z.displacement.data());
    }

    /// z = M^-1 r of the finest network, for the strains of the box.
    void apply_strain(const QuadMotion<Real>& r, QuadMotion<Real>& z) const { z.strain = strain_inverse_ * r.strain; }

    /// Adds what the coarse spaces bring to z. allowed: projector onto the strains that the box may take.
    void add_coarse(const Eigen::Matrix3d& allowed, const QuadMotion<Real>& r, QuadMotion<Real>& z);

   private:
    struct Coarse {
        const RigidClusters& clusters;
        std::vector<std::size_t> entry;  // of the finest network, of each pair of nodes
        std::vector<Vec3> branch;        // of each pair of nodes, m
        ContactNetwork network;
        std::vector<linalg::NodeRange> ranges;
        linalg::IncompleteCholesky<Real> factor;
        Eigen::Matrix3d strain_inverse = Eigen::Matrix3d::Zero();
        QuadMotion<Real> r, z;

        Coarse(const Box& box, const RigidClusters& seen, const std::vector<RigidClusters::NodePair>& rows,
               const std::vector<Pair>& pairs, const std::vector<std::size_t>& entry_of_row);
    };

    const ContactNetwork& network_;
    std::vector<linalg::NodeRange> ranges_;
    linalg::IncompleteCholesky<Real> finest_;
    Eigen::Matrix3d strain_inverse_ = Eigen::Matrix3d::Zero();
    std::vector<std::unique_ptr<Coarse>> coarse_;
};

}  // namespace kiln::sintering
