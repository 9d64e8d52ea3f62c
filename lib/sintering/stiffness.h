// stiffness.h: the stiffness of a contact network and its product with a motion: in single precision, which halves the memory
// traffic and doubles what one instruction does, or in double where stiff contacts stand beside soft ones: there the rounding of a
// stiff contact's force is more than what a soft one carries. Newton's iteration, in double, corrects what single leaves out.
#pragma once

#include <vector>

#include "sintering/contact_network.h"
#include "linalg/quad.h"

namespace kiln::sintering {

using linalg::Quad;

/// A motion, or forces, with the displacements packed; spare places are zero.
template <typename Real>
struct QuadMotion {
    std::vector<Quad<Real>> displacement;
    Vec3 strain = Vec3::Zero();

    explicit QuadMotion(std::size_t particles = 0) : displacement(particles) {}
};

template <typename Real>
class Stiffness {
   public:
    /// Keeps a reference to the network.
    explicit Stiffness(const ContactNetwork& network);

    const ContactNetwork& network() const { return network_; }

    /// Direction of an entry, a unit vector from i to j.
    void set_direction(std::size_t entry, const Vec3& normal) { direction_[entry] = linalg::quad<Real>(normal); }

    /// Stiffness of an entry along its direction and across it, in any one unit.
    void set(std::size_t entry, double normal, double tangential) {
        direction_[entry].lanes[3] = static_cast<Real>(normal - tangential);
        tangential_[entry] = static_cast<Real>(tangential);
    }

    Vec3 direction(std::size_t entry) const {
        return linalg::vector(direction_[entry]);
    }

    /// kt I + (kn - kt) n n^T of an entry.
    Eigen::Matrix3d block(std::size_t entry) const {
        const Vec3 n = direction(entry);
        Eigen::Matrix3d block = static_cast<double>(direction_[entry].lanes[3]) * n * n.transpose();
        block.diagonal().array() += static_cast<double>(tangential_[entry]);
        return block;
    }

    /// First half of a product, for one chunk: total displacements u + e*x of its particles.
    void displace(std::size_t chunk, const QuadMotion<Real>& motion, std::vector<Quad<Real>>& total) const;

    /// Second half for one chunk, once all chunks are displaced: forces on its particles. Gives the chunk's part of the work
    /// conjugate to the strains.
    Vec3 multiply(std::size_t chunk, const Vec3& strain, const std::vector<Quad<Real>>& total, QuadMotion<Real>& forces) const;

   private:
    Quad<Real> force(std::size_t entry, Quad<Real> du) const {
        const Quad<Real> n = direction_[entry];  // the spare place of du is zero, so that of n does not enter the first product
        return tangential_[entry] * du + linalg::sum(n * du) * linalg::all<3>(n) * n;
    }
    template <bool AddFirst, bool AddSecond>
    void multiply_range(std::size_t begin, std::size_t end, const Quad<Real>* total, Quad<Real>* forces) const;
    Vec3 multiply_crossing(const ContactNetwork::Chunk& chunk, const Vec3& strain, const Quad<Real>* total,
                           Quad<Real>* forces) const;

    const ContactNetwork& network_;
    std::vector<Quad<Real>> position_;     // m, from the middle of the particles' extent
    std::vector<Quad<Real>> direction_;    // of each entry, with kn - kt in the spare place
    std::vector<Real> tangential_;  // kt
};

}  // namespace kiln::sintering
