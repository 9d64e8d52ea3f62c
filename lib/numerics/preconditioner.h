// preconditioner.h: an approximate inverse of the stiffness of a contact network.
#pragma once

#include <array>
#include <vector>

#include "numerics/contact_network.h"

namespace kiln::numerics {

/// Incomplete block factorisation L D L^T without fill, IC(0), of the 3x3 blocks inside each chunk; contacts between chunks count on
/// the diagonal only. The strains of the box have their own block. Exact for a chunk whose contacts form trees, as in loose packings.
class Preconditioner {
   public:
    explicit Preconditioner(const ContactNetwork& network);

    /// Takes the network's present stiffness. levers: from node to node of each pair, m.
    void factorise(const ContactNetwork& network, std::span<const Vec3> levers);

    /// z = M^-1 r for the particles of one chunk.
    void apply(const ContactNetwork& network, std::size_t chunk, const Motion& r, Motion& z) const;

    /// z = M^-1 r for the strains of the box.
    void apply_strain(const Motion& r, Motion& z) const { z.strain = strain_inverse_ * r.strain; }

   private:
    void assemble(const ContactNetwork& network, std::size_t chunk);
    void eliminate(const ContactNetwork::Chunk& chunk);
    void factorise_strain(const ContactNetwork& network, std::span<const Vec3> levers);

    std::vector<std::size_t> row_begin_;     // blocks of a particle's row, left of the diagonal
    std::vector<std::int32_t> column_;       // ascending in a row
    std::vector<std::size_t> place_;         // of each entry that joins two particles of a chunk, its block
    std::vector<Eigen::Matrix3f> lower_;     // L; half the memory traffic in single precision, and M stays symmetric
    std::vector<Eigen::Matrix3d> diagonal_;  // of the network, then D
    std::vector<Eigen::Matrix3d> inverse_;   // of D
    Eigen::Matrix3d strain_inverse_ = Eigen::Matrix3d::Zero();
};

}  // namespace kiln::numerics
