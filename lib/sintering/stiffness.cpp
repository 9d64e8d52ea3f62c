// stiffness.cpp: factorisation, strains and couplings of a contact network, chunk by chunk.
#include "sintering/stiffness.h"

#include <algorithm>

#include "linalg/wide_registers.h"

namespace kiln::sintering {

namespace {

constexpr double min_strain_pivot = 1e-12;  // of the trace; below it no contact reaches along an axis

std::vector<linalg::NodeRange> ranges_of(const ContactNetwork& network) {
    std::vector<linalg::NodeRange> ranges;
    for (const ContactNetwork::Chunk& chunk : network.chunks())
        ranges.push_back({chunk.first_particle, chunk.last_particle, chunk.begin, chunk.first_only, chunk.end});
    return ranges;
}

}  // namespace

template <typename Real>
Stiffness<Real>::Stiffness(const ContactNetwork& network)
    : network_(network),
      springs_(network.first.size()),
      ranges_(ranges_of(network)),
      factor_(network.particles(), ranges_, network.first, network.second, springs_),
      strain_forces_(network.particles()) {}

template <typename Real>
void Stiffness<Real>::assemble(std::span<const Vec3> branch) {
    of_strain_ = network_.sum_chunks<Eigen::Matrix3d>(Eigen::Matrix3d::Zero(), [&](std::size_t chunk) {
        factor_.factorise(ranges_[chunk]);
        return linalg::in_widest_registers([&] { return find_strain_forces(chunk, branch); });
    });
    strain_inverse_ = linalg::pivot_inverse(of_strain_, of_strain_, min_strain_pivot);
}

/// Returns the chunk's part of of_strain().
template <typename Real>
Eigen::Matrix3d Stiffness<Real>::find_strain_forces(std::size_t index, std::span<const Vec3> branch) {
    const ContactNetwork::Chunk& chunk = network_.chunks()[index];
    std::fill(strain_forces_.begin() + static_cast<std::ptrdiff_t>(chunk.first_particle),
              strain_forces_.begin() + static_cast<std::ptrdiff_t>(chunk.last_particle), std::array<Quad<Real>, 3>{});
    std::array<linalg::WideQuad, 3> work;
    const auto add = [&](std::size_t entry, bool first, bool second) {
        const Quad<Real> l = linalg::quad<Real>(branch[static_cast<std::size_t>(network_.pair[entry])]);
        const std::array<Quad<Real>, 3> force = springs_.columns(entry, l);
        auto& on_first = strain_forces_[static_cast<std::size_t>(network_.first[entry])];
        auto& on_second = strain_forces_[static_cast<std::size_t>(network_.second[entry])];
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (first) on_first[axis] -= force[axis];
            if (second) on_second[axis] += force[axis];
            if (first) linalg::add_product(force[axis], l, work[axis]);
        }
    };
    for (std::size_t entry = chunk.begin; entry < chunk.first_only; ++entry) add(entry, true, true);
    for (std::size_t entry = chunk.first_only; entry < chunk.second_only; ++entry) add(entry, true, false);
    for (std::size_t entry = chunk.second_only; entry < chunk.crossing; ++entry) add(entry, false, true);
    for (std::size_t entry = chunk.crossing; entry < chunk.end; ++entry)
        add(entry, network_.owns_first(chunk, entry), network_.owns_second(chunk, entry));
    Eigen::Matrix3d part;
    for (int axis = 0; axis < 3; ++axis) part.col(axis) = work[static_cast<std::size_t>(axis)].vector();
    return 0.5 * (part + part.transpose());
}

template class Stiffness<float>;
template class Stiffness<double>;

}  // namespace kiln::sintering
