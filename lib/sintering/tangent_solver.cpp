// tangent_solver.cpp: the passes of the iteration over the particles, all in fixed chunks.
#include "sintering/tangent_solver.h"

#include <algorithm>
#include <cmath>

namespace kiln::sintering {

namespace {

/// Components [first, last) of a chunk's particles.
struct Range {
    std::size_t first, last;
};

Range components(const ContactNetwork& network, std::size_t chunk) {
    const ContactNetwork::Chunk& c = network.chunks()[chunk];
    return {3 * c.first_particle, 3 * c.last_particle};
}

/// Sum of the products of a chunk's displacements.
template <typename Real>
double dot(const ContactNetwork::Chunk& chunk, const QuadMotion<Real>& a, const QuadMotion<Real>& b) {
    linalg::WideQuad sums;
    for (std::size_t row = chunk.first_particle; row < chunk.last_particle; ++row)
        linalg::add_product(a.displacement[row], b.displacement[row], sums);
    return sums.sum();
}

/// The largest size of a component.
double max_component(const Motion& motion) {
    double most = motion.strain.cwiseAbs().maxCoeff();
    for (const double component : motion.displacement) {
        if (!std::isfinite(component)) throw Error("a force on a particle is not a finite number");
        most = std::max(most, std::abs(component));
    }
    return most;
}

}  // namespace

double dot(const ContactNetwork& network, const Motion& a, const Motion& b) {
    return a.strain.dot(b.strain) + network.sum_chunks([&](std::size_t chunk) {
        const Range range = components(network, chunk);
        double sum = 0.0;
        for (std::size_t k = range.first; k < range.last; ++k) sum += a.displacement[k] * b.displacement[k];
        return sum;
    });
}

void add(const ContactNetwork& network, double factor, const Motion& x, Motion& y) {
    network.for_chunks([&](std::size_t chunk) {
        const Range range = components(network, chunk);
        for (std::size_t k = range.first; k < range.last; ++k) y.displacement[k] += factor * x.displacement[k];
    });
    y.strain += factor * x.strain;
}

template <typename Real>
TangentSolver<Real>::TangentSolver(const Box& box, const ContactNetwork& network, std::span<const Pair> pairs,
                                   std::span<const RigidClusters> coarse)
    : network_(network),
      stiffness_(network),
      preconditioner_(box, network, pairs, coarse),
      x_(network.particles()),
      r_(network.particles()),
      z_(network.particles()),
      p_(network.particles()),
      q_(network.particles()),
      total_(network.particles()),
      work_(network.chunks().size()) {}

template <typename Real>
double TangentSolver<Real>::advance(double step) {
    x_.strain += step * p_.strain;
    r_.strain -= step * q_.strain;
    preconditioner_.apply_strain(r_, z_);
    project(z_, allowed_);
    const auto length = static_cast<Real>(step);
    const double product = network_.sum_chunks([&](std::size_t index) {
        const ContactNetwork::Chunk& chunk = network_.chunks()[index];
        for (std::size_t row = chunk.first_particle; row < chunk.last_particle; ++row) {
            x_.displacement[row] += length * p_.displacement[row];
            r_.displacement[row] -= length * q_.displacement[row];
        }
        preconditioner_.apply(index, r_, z_);
        return dot(chunk, r_, z_);
    });
    if (!preconditioner_.has_coarse_spaces()) return r_.strain.dot(z_.strain) + product;
    preconditioner_.add_coarse(allowed_, r_, z_);
    return r_.strain.dot(z_.strain) +
           network_.sum_chunks([&](std::size_t index) { return dot(network_.chunks()[index], r_, z_); });
}

template <typename Real>
double TangentSolver<Real>::turn(double ratio) {
    p_.strain = z_.strain + ratio * p_.strain;
    const auto kept = static_cast<Real>(ratio);
    network_.for_chunks([&](std::size_t index) {
        const ContactNetwork::Chunk& chunk = network_.chunks()[index];
        for (std::size_t row = chunk.first_particle; row < chunk.last_particle; ++row)
            p_.displacement[row] = z_.displacement[row] + kept * p_.displacement[row];
        stiffness_.displace(index, p_, total_);
    });
    const double curvature = network_.sum_chunks([&](std::size_t index) {
        work_[index] = stiffness_.multiply(index, p_.strain, total_, q_);
        return dot(network_.chunks()[index], p_, q_);
    });
    q_.strain.setZero();
    for (const Vec3& part : work_) q_.strain += part;
    project(q_, allowed_);
    return curvature + p_.strain.dot(q_.strain);
}

template <typename Real>
linalg::CgProgress TangentSolver<Real>::solve(const Eigen::Matrix3d& allowed, const Motion& b, Motion& x,
                                              const std::function<bool(const linalg::CgProgress&)>& done) {
    const double scale = max_component(b);
    std::fill(x.displacement.begin(), x.displacement.end(), 0.0);
    x.strain.setZero();
    if (scale == 0.0) return {};
    allowed_ = allowed;
    for (QuadMotion<Real>* motion : {&x_, &p_, &q_}) {
        std::fill(motion->displacement.begin(), motion->displacement.end(), Quad<Real>{});
        motion->strain.setZero();
    }
    for (std::size_t row = 0; row < r_.displacement.size(); ++row)
        r_.displacement[row] = linalg::quad<Real>(b.displacement[3 * row] / scale, b.displacement[3 * row + 1] / scale,
                                                  b.displacement[3 * row + 2] / scale);
    r_.strain = b.strain / scale;
    project(r_, allowed);
    const auto unscaled = [&](linalg::CgProgress progress) {
        for (double* square : {&progress.energy, &progress.error2, &progress.residual2}) *square *= scale * scale;
        return progress;
    };
    const linalg::CgProgress progress = unscaled(
        linalg::conjugate_gradient(*this, [&](const linalg::CgProgress& so_far) { return done(unscaled(so_far)); }));
    for (std::size_t row = 0; row < x_.displacement.size(); ++row)
        for (std::size_t axis = 0; axis < 3; ++axis)
            x.displacement[3 * row + axis] = scale * static_cast<double>(x_.displacement[row].lanes[axis]);
    x.strain = scale * x_.strain;
    return progress;
}

template class TangentSolver<float>;
template class TangentSolver<double>;

}  // namespace kiln::sintering
