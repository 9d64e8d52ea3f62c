// conjugate_gradients.cpp: the iteration; three passes over the particles each, all in fixed chunks.
#include "numerics/conjugate_gradients.h"

#include <algorithm>
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

ConjugateGradients::ConjugateGradients(std::size_t particles)
    : r_(particles), z_(particles), p_(particles), q_(particles), total_(3 * particles) {}

LinearSolve ConjugateGradients::solve(const ContactNetwork& network, const Preconditioner& preconditioner,
                                      const Eigen::Matrix3d& allowed, const Motion& b, Motion& x, const LinearGoal& goal) {
    std::fill(x.displacement.begin(), x.displacement.end(), 0.0);
    x.strain.setZero();
    std::fill(p_.displacement.begin(), p_.displacement.end(), 0.0);
    p_.strain.setZero();
    r_ = b;
    project(r_, allowed);
    // Subtracts step * q from r, adds step * p to x, preconditions; gives the product of r and z.
    const auto advance = [&](double step) {
        x.strain += step * p_.strain;
        r_.strain -= step * q_.strain;
        preconditioner.apply_strain(r_, z_);
        project(z_, allowed);
        return r_.strain.dot(z_.strain) + network.sum_chunks([&](std::size_t chunk) {
            const Range range = components(network, chunk);
            if (step != 0.0)
                for (std::size_t k = range.first; k < range.last; ++k) {
                    x.displacement[k] += step * p_.displacement[k];
                    r_.displacement[k] -= step * q_.displacement[k];
                }
            preconditioner.apply(network, chunk, r_, z_);
            double sum = 0.0;
            for (std::size_t k = range.first; k < range.last; ++k) sum += r_.displacement[k] * z_.displacement[k];
            return sum;
        });
    };
    // The next direction p = z + ratio * p, and q = K p; gives the product of p and q.
    std::vector<Vec3> work(network.chunks().size());
    const auto stiffness_along = [&](double ratio) {
        p_.strain = z_.strain + ratio * p_.strain;
        network.for_chunks([&](std::size_t chunk) {
            const Range range = components(network, chunk);
            for (std::size_t k = range.first; k < range.last; ++k) p_.displacement[k] = z_.displacement[k] + ratio * p_.displacement[k];
            network.displace(chunk, p_, total_);
        });
        const double curvature = network.sum_chunks([&](std::size_t chunk) {
            work[chunk] = network.gather_chunk(chunk, p_.strain, total_, q_, StiffnessForce{network});
            const Range range = components(network, chunk);
            double sum = 0.0;
            for (std::size_t k = range.first; k < range.last; ++k) sum += p_.displacement[k] * q_.displacement[k];
            return sum;
        });
        q_.strain.setZero();
        for (const Vec3& part : work) q_.strain += part;
        project(q_, allowed);
        return curvature + p_.strain.dot(q_.strain);
    };

    const double start = advance(0.0);
    const double relative = goal.scale > 0.0 ? std::clamp(std::sqrt(start / goal.scale), goal.tightest, goal.loosest) : goal.tightest;
    const double wanted = std::max(relative * relative * start, goal.enough);
    double product = start, ratio = 0.0;
    LinearSolve report{.start = start};
    while (product > wanted && report.iterations < goal.most_iterations) {
        const double curvature = stiffness_along(ratio);
        if (!(curvature > 0.0)) break;  // only motion that costs nothing is left
        const double next = advance(product / curvature);
        ratio = next / product;
        product = next;
        ++report.iterations;
    }
    report.residual = start > 0.0 ? std::sqrt(product / start) : 0.0;
    return report;
}

}  // namespace kiln::numerics
