// conjugate_gradients.cpp: the iteration; three passes over the particles each, all in fixed chunks.
#include "numerics/conjugate_gradients.h"

#include <cmath>

namespace kiln::numerics {

namespace {

/// Components [first, last) of a chunk's particles.
struct Range {
    std::size_t first, last;
};

Range components(const ContactNetwork& network, std::size_t chunk) {
    const ContactNetwork::Chunk& c = network.chunks()[chunk];
    return {3 * c.first_particle, 3 * c.last_particle};
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

void mask(Motion& motion, const std::array<bool, 3>& free_axis) {
    for (int axis = 0; axis < 3; ++axis)
        if (!free_axis[static_cast<std::size_t>(axis)]) motion.strain[axis] = 0.0;
}

ConjugateGradients::ConjugateGradients(std::size_t particles)
    : r_(particles), z_(particles), p_(particles), q_(particles), total_(3 * particles) {}

LinearSolve ConjugateGradients::solve(const ContactNetwork& network, const Preconditioner& preconditioner,
                                      const std::array<bool, 3>& free_axis, const Motion& b, Motion& x, double tolerance,
                                      int most_iterations) {
    std::fill(x.displacement.begin(), x.displacement.end(), 0.0);
    x.strain.setZero();
    r_ = b;
    mask(r_, free_axis);
    preconditioner.apply(network, r_, z_);
    mask(z_, free_axis);
    p_ = z_;
    double product = dot(network, r_, z_);
    const double wanted = tolerance * tolerance * product;
    const double start = product;
    LinearSolve report;
    while (product > wanted && report.iterations < most_iterations) {
        apply_stiffness(network, p_, q_, total_);
        mask(q_, free_axis);
        const double curvature = dot(network, p_, q_);
        if (!(curvature > 0.0)) break;  // only motion that costs nothing is left
        const double step = product / curvature;
        add(network, step, p_, x);
        add(network, -step, q_, r_);
        preconditioner.apply(network, r_, z_);
        mask(z_, free_axis);
        const double next = dot(network, r_, z_);
        const double ratio = next / product;
        network.for_chunks([&](std::size_t chunk) {
            const Range range = components(network, chunk);
            for (std::size_t k = range.first; k < range.last; ++k) p_.displacement[k] = z_.displacement[k] + ratio * p_.displacement[k];
        });
        p_.strain = z_.strain + ratio * p_.strain;
        product = next;
        ++report.iterations;
    }
    report.residual = start > 0.0 ? std::sqrt(product / start) : 0.0;
    return report;
}

}  // namespace kiln::numerics
