// stiffness.h: the stiffness of a contact network with the strains of its box: in single precision, which halves the memory
// traffic and doubles what one instruction does, or in double where stiff contacts stand beside soft ones: there the rounding of a
// stiff contact's force is more than what a soft one carries. Newton's iteration, in double, corrects what single leaves out.
#pragma once

#include <vector>

#include "linalg/incomplete_cholesky.h"
#include "sintering/contact_network.h"

namespace kiln::sintering {

using linalg::Quad;

/// A motion, or forces, with the displacements packed; spare places are zero.
template <typename Real>
struct QuadMotion {
    std::vector<Quad<Real>> displacement;
    Vec3 strain = Vec3::Zero();

    explicit QuadMotion(std::size_t particles = 0) : displacement(particles) {}
};

/// Springs of the entries of a network, what strains of the box do to its particles, and the factorisation of each chunk.
template <typename Real>
class Stiffness {
   public:
    /// Keeps a reference to the network.
    explicit Stiffness(const ContactNetwork& network);
    Stiffness(const Stiffness&) = delete;  // the factor refers to the springs
    Stiffness& operator=(const Stiffness&) = delete;

    const ContactNetwork& network() const { return network_; }
    linalg::EdgeStiffness<Real>& springs() { return springs_; }
    const linalg::EdgeStiffness<Real>& springs() const { return springs_; }

    /// Takes the present springs into all that follows. branch: from node to node of each pair, m.
    void assemble(std::span<const Vec3> branch);

    const linalg::IncompleteCholesky<Real>& factor() const { return factor_; }
    const linalg::NodeRange& range(std::size_t chunk) const { return ranges_[chunk]; }

    /// Work conjugate to each strain for a unit of each, all particles following the box; its inverse along the axes that contacts
    /// reach through.
    const Eigen::Matrix3d& of_strain() const { return of_strain_; }
    const Eigen::Matrix3d& strain_inverse() const { return strain_inverse_; }

    /// Forces that a unit of each strain exerts on a particle that follows the box.
    const std::array<Quad<Real>, 3>& strain_forces(std::size_t particle) const { return strain_forces_[particle]; }

    /// Adds up, for each particle of a chunk, the springs to particles of other chunks and through the faces of the box, times the
    /// displacements of those.
    void add_outer(std::size_t chunk, const std::vector<Quad<Real>>& displacement, Quad<Real>* sums) const;

   private:
    Eigen::Matrix3d find_strain_forces(std::size_t chunk, std::span<const Vec3> branch);

    const ContactNetwork& network_;
    linalg::EdgeStiffness<Real> springs_;
    std::vector<linalg::NodeRange> ranges_;  // of the chunks
    linalg::IncompleteCholesky<Real> factor_;
    std::vector<std::array<Quad<Real>, 3>> strain_forces_;  // of each particle
    Eigen::Matrix3d of_strain_ = Eigen::Matrix3d::Zero(), strain_inverse_ = Eigen::Matrix3d::Zero();
};

template <typename Real>
void Stiffness<Real>::add_outer(std::size_t index, const std::vector<Quad<Real>>& displacement, Quad<Real>* sums) const {
    const ContactNetwork::Chunk& chunk = network_.chunks()[index];
    const auto add = [&](std::size_t entry, std::int32_t own, std::int32_t other) {
        sums[static_cast<std::size_t>(own) - chunk.first_particle] +=
            springs_.product(entry, displacement[static_cast<std::size_t>(other)]);
    };
    for (std::size_t entry = chunk.first_only; entry < chunk.second_only; ++entry)
        add(entry, network_.first[entry], network_.second[entry]);
    for (std::size_t entry = chunk.second_only; entry < chunk.crossing; ++entry)
        add(entry, network_.second[entry], network_.first[entry]);
    for (std::size_t entry = chunk.crossing; entry < chunk.end; ++entry) {
        const std::int32_t first = network_.first[entry], second = network_.second[entry];
        if (first == second) continue;  // its own image: no relative motion but by strain
        if (network_.owns_first(chunk, entry)) add(entry, first, second);
        if (network_.owns_second(chunk, entry)) add(entry, second, first);
    }
}

}  // namespace kiln::sintering
