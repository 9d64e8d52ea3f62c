// conjugate_gradients.cpp: the iteration; three passes over the particles each, all in fixed chunks.
#include "sintering/conjugate_gradients.h"

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
double dot(const ContactNetwork::Chunk& chunk, const QuadMotion& a, const QuadMotion& b) {
    WideQuad sums;
    for (std::size_t row = chunk.first_particle; row < chunk.last_particle; ++row)
        add_product(a.displacement[row], b.displacement[row], sums);
    return sums.sum();
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

ConjugateGradients::ConjugateGradients(std::size_t particles)
    : x_(particles), r_(particles), z_(particles), p_(particles), q_(particles), total_(particles) {}

double ConjugateGradients::advance(const Stiffness& stiffness, const Preconditioner& preconditioner, const Eigen::Matrix3d& allowed,
                                   double step) {
    const ContactNetwork& network = stiffness.network();
    x_.strain += step * p_.strain;
    r_.strain -= step * q_.strain;
    preconditioner.apply_strain(r_, z_);
    project(z_, allowed);
    const auto length = static_cast<float>(step);
    return r_.strain.dot(z_.strain) + network.sum_chunks([&](std::size_t index) {
        const ContactNetwork::Chunk& chunk = network.chunks()[index];
        for (std::size_t row = chunk.first_particle; row < chunk.last_particle; ++row) {
            x_.displacement[row] += length * p_.displacement[row];
            r_.displacement[row] -= length * q_.displacement[row];
        }
        preconditioner.apply(chunk, r_, z_);
        return dot(chunk, r_, z_);
    });
}

double ConjugateGradients::turn(const Stiffness& stiffness, const Eigen::Matrix3d& allowed, double ratio) {
    const ContactNetwork& network = stiffness.network();
    p_.strain = z_.strain + ratio * p_.strain;
    const auto kept = static_cast<float>(ratio);
    network.for_chunks([&](std::size_t index) {
        const ContactNetwork::Chunk& chunk = network.chunks()[index];
        for (std::size_t row = chunk.first_particle; row < chunk.last_particle; ++row)
            p_.displacement[row] = z_.displacement[row] + kept * p_.displacement[row];
        stiffness.displace(index, p_, total_);
    });
    work_.resize(network.chunks().size());
    const double curvature = network.sum_chunks([&](std::size_t index) {
        work_[index] = stiffness.multiply(index, p_.strain, total_, q_);
        return dot(network.chunks()[index], p_, q_);
    });
    q_.strain.setZero();
    for (const Vec3& part : work_) q_.strain += part;
    project(q_, allowed);
    return curvature + p_.strain.dot(q_.strain);
}

LinearSolve ConjugateGradients::solve(const Stiffness& stiffness, const Preconditioner& preconditioner,
                                      const Eigen::Matrix3d& allowed, const Motion& b, Motion& x, const LinearGoal& goal) {
    for (QuadMotion* motion : {&x_, &p_, &q_}) {
        std::fill(motion->displacement.begin(), motion->displacement.end(), Quad{});
        motion->strain.setZero();
    }
    for (std::size_t row = 0; row < r_.displacement.size(); ++row)
        r_.displacement[row] = quad(b.displacement[3 * row], b.displacement[3 * row + 1], b.displacement[3 * row + 2]);
    r_.strain = b.strain;
    project(r_, allowed);

    const double start = advance(stiffness, preconditioner, allowed, 0.0);
    const double relative =
        goal.scale > 0.0 ? std::clamp(std::sqrt(start / goal.scale), goal.tightest, goal.loosest) : goal.tightest;
    const double wanted = std::max(relative * relative * start, goal.enough);
    double product = start, ratio = 0.0;
    LinearSolve report{.start = start};
    while (product > wanted && report.iterations < goal.most_iterations) {
        const double curvature = turn(stiffness, allowed, ratio);
        if (!(curvature > 0.0)) break;  // only motion that costs nothing is left
        const double next = advance(stiffness, preconditioner, allowed, product / curvature);
        ratio = next / product;
        product = next;
        ++report.iterations;
    }
    report.residual = start > 0.0 ? std::sqrt(product / start) : 0.0;
    for (std::size_t row = 0; row < x_.displacement.size(); ++row)
        for (std::size_t axis = 0; axis < 3; ++axis)
            x.displacement[3 * row + axis] = static_cast<double>(x_.displacement[row].lanes[axis]);
    x.strain = x_.strain;
    return report;
}

}  // namespace kiln::sintering
