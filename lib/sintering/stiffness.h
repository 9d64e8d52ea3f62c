// stiffness.h: the stiffness of a contact network and its product with a motion, in single precision, which halves the memory
// traffic and doubles what one instruction does. Newton's iteration, in double precision, corrects what that leaves out.
#pragma once

#include <vector>

#include "sintering/contact_network.h"
#include "sintering/quad.h"

namespace kiln::sintering {

/// A motion, or forces, with the displacements in single precision; spare places are zero.
struct QuadMotion {
    std::vector<Quad> displacement;
    Vec3 strain = Vec3::Zero();

    explicit QuadMotion(std::size_t particles = 0) : displacement(particles) {}
};

class Stiffness {
   public:
    /// Keeps a reference to the network.
    explicit Stiffness(const ContactNetwork& network);

    const ContactNetwork& network() const { return network_; }

    /// Direction of an entry, a unit vector from i to j.
    void set_direction(std::size_t entry, const Vec3& normal) { direction_[entry] = quad(normal); }

    /// Stiffness of an entry along its direction and across it, in any one unit.
    void set(std::size_t entry, double normal, double tangential) {
        direction_[entry].lanes[3] = static_cast<float>(normal - tangential);
        tangential_[entry] = static_cast<float>(tangential);
    }

    Vec3 direction(std::size_t entry) const {
        const Quad::Lanes& n = direction_[entry].lanes;
        return {n[0], n[1], n[2]};
    }

    /// kt I + (kn - kt) n n^T of an entry.
    Eigen::Matrix3d block(std::size_t entry) const {
        const Vec3 n = direction(entry);
        Eigen::Matrix3d block = static_cast<double>(direction_[entry].lanes[3]) * n * n.transpose();
        block.diagonal().array() += static_cast<double>(tangential_[entry]);
        return block;
    }

    /// First half of a product, for one chunk: total displacements u + e*x of its particles.
    void displace(std::size_t chunk, const QuadMotion& motion, std::vector<Quad>& total) const;

    /// Second half for one chunk, once all chunks are displaced: forces on its particles. Gives the chunk's part of the work
    /// conjugate to the strains.
    Vec3 multiply(std::size_t chunk, const Vec3& strain, const std::vector<Quad>& total, QuadMotion& forces) const;

   private:
    Quad force(std::size_t entry, Quad du) const {
        const Quad n = direction_[entry];  // the spare place of du is zero, so that of n does not enter the first product
        return tangential_[entry] * du + sum(n * du) * all<3>(n) * n;
    }
    template <bool AddFirst, bool AddSecond>
    void multiply_range(std::size_t begin, std::size_t end, const Quad* total, Quad* forces) const;
    Vec3 multiply_crossing(const ContactNetwork::Chunk& chunk, const Vec3& strain, const Quad* total, Quad* forces) const;

    const ContactNetwork& network_;
    std::vector<Quad> position_;     // m, from the middle of the particles' extent
    std::vector<Quad> direction_;    // of each entry, with kn - kt in the spare place
    std::vector<float> tangential_;  // kt
};

}  // namespace kiln::sintering
