// few_particles.cpp: neighbours of a few particles, and conjugate gradients on them.
#include "sintering/few_particles.h"

#include <Eigen/Cholesky>
#include <cstdint>

#include "linalg/conjugate_gradient.h"

namespace kiln::sintering {

namespace {

using Eigen::Matrix3d;

constexpr std::uint8_t rings = 3;        // of neighbours that move with a particle
constexpr double goal = 0.03;            // error of their motion, energy norm
constexpr int max_iterations = 300;
constexpr double least_stiffness = 1e-9; // of a particle's block, over its trace: some directions have no contact

/// Of each particle how many contacts it is away, up to the rings; beyond, rings + 1.
std::vector<std::uint8_t> distances(const ContactNetwork& network, const std::vector<std::size_t>& particles) {
    std::vector<std::uint8_t> distance(network.particles(), rings + 1);
    for (const std::size_t row : particles) distance[row] = 0;
    for (std::uint8_t ring = 0; ring < rings; ++ring)
        for (std::size_t chunk = 0; chunk < network.chunks().size(); ++chunk)
            network.for_owned(chunk, [&](std::size_t entry) {
                std::uint8_t& first = distance[static_cast<std::size_t>(network.first[entry])];
                std::uint8_t& second = distance[static_cast<std::size_t>(network.second[entry])];
                if (first == ring && second > ring) second = ring + 1;
                if (second == ring && first > ring) first = ring + 1;
            });
    return distance;
}

/// The particles that move, for linalg::conjugate_gradient; M is the diagonal of K by particles.
class FewParticles {
   public:
    FewParticles(const ContactNetwork& network, const ContactStiffness& stiffness, const std::vector<std::size_t>& particles,
                 const Motion& force) {
        const std::vector<std::uint8_t> distance = distances(network, particles);
        std::vector<std::int32_t> place(network.particles(), held);
        for (std::size_t row = 0; row < distance.size(); ++row) {
            if (distance[row] > rings) continue;
            place[row] = static_cast<std::int32_t>(rows_.size());
            rows_.push_back(row);
            r_.emplace_back(Eigen::Map<const Vec3>(&force.displacement[3 * row]));
        }
        std::vector<Matrix3d> diagonal(rows_.size(), Matrix3d::Zero());
        for (std::size_t chunk = 0; chunk < network.chunks().size(); ++chunk)
            network.for_owned(chunk, [&](std::size_t entry) {
                const std::int32_t first = place[static_cast<std::size_t>(network.first[entry])];
                const std::int32_t second = place[static_cast<std::size_t>(network.second[entry])];
                if (first == held && second == held) return;
                const Matrix3d block = stiffness(entry);
                springs_.push_back({first, second, block});
                for (const std::int32_t own : {first, second})
                    if (own != held) diagonal[at(own)] += block;
            });
        for (const Matrix3d& block : diagonal) {
            const double least = least_stiffness * block.trace();
            inverse_.emplace_back(least > 0.0 ? (block + least * Matrix3d::Identity()).llt().solve(Matrix3d::Identity()).eval()
                                              : Matrix3d::Zero().eval());
        }
        x_.assign(rows_.size(), Vec3::Zero());
        z_ = p_ = q_ = x_;
    }

    double advance(double step) {
        double product = 0.0;
        for (std::size_t k = 0; k < x_.size(); ++k) {
            x_[k] += step * p_[k];
            r_[k] -= step * q_[k];
            z_[k] = inverse_[k] * r_[k];
            product += r_[k].dot(z_[k]);
        }
        return product;
    }

    double turn(double ratio) {
        for (std::size_t k = 0; k < p_.size(); ++k) {
            p_[k] = z_[k] + ratio * p_[k];
            q_[k].setZero();
        }
        for (const Spring& spring : springs_) {
            Vec3 opening = Vec3::Zero();
            if (spring.second != held) opening += p_[at(spring.second)];
            if (spring.first != held) opening -= p_[at(spring.first)];
            const Vec3 force = spring.stiffness * opening;
            if (spring.second != held) q_[at(spring.second)] += force;
            if (spring.first != held) q_[at(spring.first)] -= force;
        }
        double product = 0.0;
        for (std::size_t k = 0; k < p_.size(); ++k) product += p_[k].dot(q_[k]);
        return product;
    }

    void add_to(Motion& motion) const {
        for (std::size_t k = 0; k < rows_.size(); ++k) Eigen::Map<Vec3>(&motion.displacement[3 * rows_[k]]) += x_[k];
    }

   private:
    static constexpr std::int32_t held = -1;
    static std::size_t at(std::int32_t index) { return static_cast<std::size_t>(index); }

    struct Spring {
        std::int32_t first, second;  // that move, or held
        Matrix3d stiffness;
    };

    std::vector<std::size_t> rows_;  // that move
    std::vector<Spring> springs_;
    std::vector<Matrix3d> inverse_;
    std::vector<Vec3> x_, r_, z_, p_, q_;
};

}  // namespace

void relax_few(const ContactNetwork& network, const ContactStiffness& stiffness, const std::vector<std::size_t>& particles,
               const Motion& force, Motion& motion) {
    FewParticles few(network, stiffness, particles, force);
    linalg::conjugate_gradient(few, [&](const linalg::CgProgress& progress) {
        return progress.iterations >= max_iterations || progress.error2 <= goal * goal * progress.energy;
    });
    std::fill(motion.displacement.begin(), motion.displacement.end(), 0.0);
    motion.strain.setZero();
    few.add_to(motion);
}

}  // namespace kiln::sintering
