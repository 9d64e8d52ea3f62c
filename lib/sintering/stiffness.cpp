// stiffness.cpp: the product of the stiffness with a motion, chunk by chunk.
#include "sintering/stiffness.h"

#include <algorithm>

namespace kiln::sintering {

template <typename Real>
Stiffness<Real>::Stiffness(const ContactNetwork& network)
    : network_(network), position_(network.particles()), direction_(network.first.size()), tangential_(network.first.size()) {
    Vec3 low = Vec3::Zero(), high = Vec3::Zero();
    if (network.particles() > 0) low = high = network.position(0);
    for (std::size_t row = 0; row < network.particles(); ++row) {
        low = low.cwiseMin(network.position(row));
        high = high.cwiseMax(network.position(row));
    }
    const Vec3 middle = 0.5 * (low + high);
    for (std::size_t row = 0; row < network.particles(); ++row)
        position_[row] = linalg::quad<Real>(Vec3(network.position(row) - middle));
}

template <typename Real>
void Stiffness<Real>::displace(std::size_t index, const QuadMotion<Real>& motion, std::vector<Quad<Real>>& total) const {
    const ContactNetwork::Chunk& chunk = network_.chunks()[index];
    const Quad<Real> strain = linalg::quad<Real>(motion.strain);
    for (std::size_t row = chunk.first_particle; row < chunk.last_particle; ++row)
        total[row] = motion.displacement[row] + strain * position_[row];
}

template <typename Real>
template <bool AddFirst, bool AddSecond>
void Stiffness<Real>::multiply_range(std::size_t begin, std::size_t end, const Quad<Real>* total, Quad<Real>* forces) const {
    const auto add = [&](std::size_t entry) {
        const auto i = static_cast<std::size_t>(network_.first[entry]), j = static_cast<std::size_t>(network_.second[entry]);
        const Quad<Real> f = force(entry, total[j] - total[i]);
        if constexpr (AddFirst) forces[i] -= f;
        if constexpr (AddSecond) forces[j] += f;
    };
    // Neighbouring entries add to the same particle, each waiting for the one before: from both halves in turn they wait half as
    // long.
    const std::size_t half = (end - begin) / 2;
    for (std::size_t entry = begin; entry < begin + half; ++entry) {
        add(entry);
        add(entry + half);
    }
    if (begin + 2 * half < end) add(end - 1);
}

template <typename Real>
Vec3 Stiffness<Real>::multiply_crossing(const ContactNetwork::Chunk& chunk, const Vec3& strain, const Quad<Real>* total,
                                        Quad<Real>* forces) const {
    Vec3 work = Vec3::Zero();
    for (std::size_t entry = chunk.crossing; entry < chunk.end; ++entry) {
        const auto i = static_cast<std::size_t>(network_.first[entry]), j = static_cast<std::size_t>(network_.second[entry]);
        const Vec3& shift = network_.shift(chunk, entry);
        const Quad<Real> f = force(entry, total[j] - total[i] + linalg::quad<Real>(Vec3(strain.cwiseProduct(shift))));
        if (network_.owns_first(chunk, entry)) {
            work += linalg::vector(f).cwiseProduct(shift);
            forces[i] -= f;
        }
        if (network_.owns_second(chunk, entry)) forces[j] += f;
    }
    return work;
}

template <typename Real>
Vec3 Stiffness<Real>::multiply(std::size_t index, const Vec3& strain, const std::vector<Quad<Real>>& total,
                               QuadMotion<Real>& forces) const {
    const ContactNetwork::Chunk& chunk = network_.chunks()[index];
    Quad<Real>* target = forces.displacement.data();
    std::fill(target + chunk.first_particle, target + chunk.last_particle, Quad<Real>{});
    multiply_range<true, true>(chunk.begin, chunk.first_only, total.data(), target);
    multiply_range<true, false>(chunk.first_only, chunk.second_only, total.data(), target);
    multiply_range<false, true>(chunk.second_only, chunk.crossing, total.data(), target);
    const Vec3 crossing = multiply_crossing(chunk, strain, total.data(), target);
    // Sum of f * l: with l = x_j + shift - x_i it is the sum of the particles' forces times their positions, and the shifts.
    linalg::WideQuad work;
    for (std::size_t row = chunk.first_particle; row < chunk.last_particle; ++row) {
        target[row] = linalg::only_vector(target[row]);
        linalg::add_product(target[row], position_[row], work);
    }
    return crossing + work.vector();
}

template class Stiffness<float>;
template class Stiffness<double>;

}  // namespace kiln::sintering
