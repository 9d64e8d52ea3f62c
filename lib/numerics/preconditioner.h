// preconditioner.h: an approximate inverse of the stiffness of a contact network.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "numerics/contact_network.h"

namespace kiln::numerics {

/// Inverse of the 3x3 diagonal block of every particle, and of the block of the box's strains.
class Preconditioner {
   public:
    /// Takes the network's present stiffness. vectors: l of each pair, m.
    void factorise(const ContactNetwork& network, std::span<const Vec3> vectors);

    /// z = M^-1 r.
    void apply(const ContactNetwork& network, const Motion& r, Motion& z) const;

   private:
    std::vector<Eigen::Matrix3d> inverse_;
    Eigen::Matrix3d strain_inverse_ = Eigen::Matrix3d::Zero();
};

}  // namespace kiln::numerics
