// preconditioner.h: an approximate inverse of the stiffness of a contact network.
#pragma once

#include <span>
#include <vector>

#include "sintering/stiffness.h"

namespace kiln::sintering {

/// Incomplete block factorisation L D L^T without fill, IC(0), of the 3x3 blocks inside each chunk; contacts between chunks count
/// on the diagonal only. The strains of the box have their own block. Exact where no particle of a chunk has two neighbours in
/// later rows.
class Preconditioner {
   public:
    explicit Preconditioner(const ContactNetwork& network);

    /// Takes the present stiffness. levers: from node to node of each pair, m.
    void factorise(const Stiffness& stiffness, std::span<const Vec3> levers);

    /// z = M^-1 r for the particles of one chunk.
    void apply(const ContactNetwork::Chunk& chunk, const QuadMotion& r, QuadMotion& z) const;

    /// z = M^-1 r for the strains of the box.
    void apply_strain(const QuadMotion& r, QuadMotion& z) const { z.strain = strain_inverse_ * r.strain; }

   private:
    static Eigen::Map<Eigen::Matrix3f> block(std::vector<float>& blocks, std::size_t index) {
        return Eigen::Map<Eigen::Matrix3f>(&blocks[block_floats * index]);
    }
    void assemble(const Stiffness& stiffness, std::size_t chunk);
    void eliminate(const ContactNetwork::Chunk& chunk);
    void factorise_strain(const Stiffness& stiffness, std::span<const Vec3> levers);

    static constexpr std::size_t block_floats = 9;  // of a 3x3 block, by columns

    std::vector<std::size_t> row_begin_;     // blocks of a particle's row, left of the diagonal
    std::vector<std::int32_t> column_;       // ascending in a row
    std::vector<std::size_t> place_;         // of each entry that joins two particles of a chunk, its block
    std::vector<float> lower_;               // L, and room to read the last column as four numbers; M stays symmetric
    std::vector<Eigen::Matrix3d> diagonal_;  // of the stiffness, then D
    std::vector<float> inverse_;             // of D, as L
    Eigen::Matrix3d strain_inverse_ = Eigen::Matrix3d::Zero();
};

}  // namespace kiln::sintering
