// preconditioner.cpp: block-Jacobi.
#include "numerics/preconditioner.h"

#include <Eigen/Dense>

namespace kiln::numerics {

namespace {

/// Inverse of a symmetric positive semidefinite block; zero along directions without stiffness.
Eigen::Matrix3d pseudo_inverse(const Eigen::Matrix3d& block) {
    constexpr double relative_floor = 1e-12;
    const double trace = block.trace();
    if (!(trace > 0.0)) return Eigen::Matrix3d::Zero();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(block);
    Vec3 inverse = solver.eigenvalues();
    for (int k = 0; k < 3; ++k) inverse[k] = inverse[k] > relative_floor * trace ? 1.0 / inverse[k] : 0.0;
    return solver.eigenvectors() * inverse.asDiagonal() * solver.eigenvectors().transpose();
}

Eigen::Matrix3d stiffness_of(const ContactNetwork& network, std::size_t entry) {
    const Vec3 n(network.nx[entry], network.ny[entry], network.nz[entry]);
    return network.tangential[entry] * Eigen::Matrix3d::Identity() +
           (network.normal[entry] - network.tangential[entry]) * n * n.transpose();
}

}  // namespace

void Preconditioner::factorise(const ContactNetwork& network, std::span<const Vec3> vectors) {
    inverse_.assign(network.particles(), Eigen::Matrix3d::Zero());
    std::vector<Eigen::Matrix3d> strain_parts(network.chunks().size(), Eigen::Matrix3d::Zero());
    network.for_chunks([&](std::size_t index) {
        const ContactNetwork::Chunk& chunk = network.chunks()[index];
        const auto own = [&](std::int32_t particle) {
            const auto row = static_cast<std::size_t>(particle);
            return row >= chunk.first_particle && row < chunk.last_particle;
        };
        for (std::size_t entry = chunk.begin; entry < chunk.end; ++entry) {
            if (network.first[entry] == network.second[entry]) continue;  // its own image: no relative motion but by strain
            const Eigen::Matrix3d block = stiffness_of(network, entry);
            for (const std::int32_t particle : {network.first[entry], network.second[entry]})
                if (own(particle)) inverse_[static_cast<std::size_t>(particle)] += block;
        }
        for (std::size_t row = chunk.first_particle; row < chunk.last_particle; ++row) inverse_[row] = pseudo_inverse(inverse_[row]);
        network.for_owned(index, [&](std::size_t entry) {
            const Vec3& l = vectors[static_cast<std::size_t>(network.pair[entry])];
            strain_parts[index] += l.asDiagonal() * stiffness_of(network, entry) * l.asDiagonal();
        });
    });
    Eigen::Matrix3d strain = Eigen::Matrix3d::Zero();
    for (const Eigen::Matrix3d& part : strain_parts) strain += part;
    strain_inverse_ = pseudo_inverse(strain);
}

void Preconditioner::apply(const ContactNetwork& network, const Motion& r, Motion& z) const {
    network.for_chunks([&](std::size_t index) {
        const ContactNetwork::Chunk& chunk = network.chunks()[index];
        for (std::size_t row = chunk.first_particle; row < chunk.last_particle; ++row) {
            const Eigen::Map<const Vec3> residual(&r.displacement[3 * row]);
            Eigen::Map<Vec3>(&z.displacement[3 * row]) = inverse_[row] * residual;
        }
    });
    z.strain = strain_inverse_ * r.strain;
}

}  // namespace kiln::numerics
