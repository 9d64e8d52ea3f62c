// tangent_solver.cpp: the passes of the iteration over the particles, all in fixed chunks.
#include "sintering/tangent_solver.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "linalg/wide_registers.h"

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

/// The largest size of a number, or a number that is not finite.
struct Largest {
    double size = 0.0;
    void operator+=(const Largest& other) { take(other.size); }
    void take(double number) {
        if (!(std::abs(number) <= size)) size = std::isnan(size) ? size : std::abs(number);
    }
};

}  // namespace

double dot(const ContactNetwork& network, const Motion& a, const Motion& b) {
    return a.strain.dot(b.strain) + network.sum_chunks(0.0, [&](std::size_t chunk) {
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
      coarse_(box, network, pairs, coarse),
      x_(network.particles()),
      p_(network.particles()),
      y_(network.particles()),
      residual_(network.particles()),
      product_(network.particles()),
      known_(network.particles()),
      coarse_r_(coarse.empty() ? 0 : network.particles()),
      coarse_z_(coarse.empty() ? 0 : network.particles()) {}

template <typename Real>
void TangentSolver<Real>::factorise(std::span<const Vec3> branch) {
    stiffness_.assemble(branch);
    coarse_.factorise(stiffness_.springs());
}

/// The residual of x = 0, and zeros. Returns the product of the residual with the preconditioned one.
template <typename Real>
double TangentSolver<Real>::start(std::size_t index, const Motion& b, double scale) {
    const linalg::NodeRange& range = stiffness_.range(index);
    for (auto* field : {&x_, &p_, &y_, &product_})
        std::fill(field->begin() + static_cast<std::ptrdiff_t>(range.first_node),
                  field->begin() + static_cast<std::ptrdiff_t>(range.last_node), Quad<Real>{});
    std::array<Quad<Real>, ContactNetwork::chunk_particles> sums{};
    linalg::WideQuad product;
    stiffness_.factor().forward(range, sums.data(), [&](std::size_t node, Quad<Real> sum) {
        residual_[node] = sum + linalg::quad<Real>(b.displacement[3 * node] / scale, b.displacement[3 * node + 1] / scale,
                                                   b.displacement[3 * node + 2] / scale);
        const Quad<Real> value = stiffness_.factor().inverse(node) * residual_[node];
        linalg::add_product(residual_[node], value, product);
        return value;
    });
    return product.sum();
}

/// Returns the product of the residual with the preconditioned one.
template <typename Real>
double TangentSolver<Real>::take_step(std::size_t index, Real step) {
    const linalg::NodeRange& range = stiffness_.range(index);
    linalg::WideQuad product;
    for (std::size_t row = range.first_node; row < range.last_node; ++row) {
        x_[row] += step * p_[row];
        residual_[row] -= step * product_[row];
        linalg::add_product(residual_[row], stiffness_.factor().inverse(row) * residual_[row], product);
    }
    return product.sum();
}

/// Without coarse spaces the step itself is left to turn(): the product of the residual after it follows from those before it.
template <typename Real>
double TangentSolver<Real>::advance(double step) {
    x_strain_ += step * p_strain_;
    residual_strain_ -= step * product_strain_;
    z_strain_ = allowed_ * (stiffness_.strain_inverse() * residual_strain_);
    double product = 0.0;
    if (coarse_.empty()) {
        step_ = step;
        product = std::max(residual2_ - 2.0 * step * product_of_.residual + step * step * product_of_.square, 0.0);
    } else {
        product = network_.sum_chunks(0.0, [&](std::size_t index) { return take_step(index, static_cast<Real>(step)); });
        product += apply_coarse();
    }
    return product + residual_strain_.dot(z_strain_);
}

/// Leaves in coarse_z_ what the coarse spaces bring to y, and adds it to the strains. Returns its product with the residual.
template <typename Real>
double TangentSolver<Real>::apply_coarse() {
    const linalg::IncompleteCholesky<Real>& factor = stiffness_.factor();
    network_.for_chunks([&](std::size_t index) {  // r = (D + L) w
        std::array<Quad<Real>, ContactNetwork::chunk_particles> sums{};
        factor.forward(stiffness_.range(index), sums.data(), [&](std::size_t node, Quad<Real> sum) {
            coarse_r_.displacement[node] = residual_[node] - sum;
            return factor.inverse(node) * residual_[node];
        });
    });
    coarse_r_.strain = residual_strain_;
    coarse_.apply(allowed_, coarse_r_, coarse_z_);
    z_strain_ += coarse_z_.strain;
    return network_.sum_chunks(0.0, [&](std::size_t index) {  // y = D^-1 (D + L^T) z
        linalg::WideQuad sums;
        factor.backward(stiffness_.range(index), coarse_z_.displacement.data(), [&](std::size_t node, Quad<Real> sum) {
            linalg::add_product(coarse_r_.displacement[node], coarse_z_.displacement[node], sums);
            coarse_r_.displacement[node] = coarse_z_.displacement[node] - factor.inverse(node) * sum;
        });
        return sums.sum();
    });
}

/// The step that is left along the last p, then the next p. Returns the product of the residual with the preconditioned one.
template <typename Real>
double TangentSolver<Real>::find_direction(std::size_t index, Real step, Real ratio) {
    const linalg::IncompleteCholesky<Real>& factor = stiffness_.factor();
    linalg::WideQuad product;
    factor.backward(stiffness_.range(index), p_.data(), [&](std::size_t node, Quad<Real> sum) {
        x_[node] += step * p_[node];
        const Quad<Real> residual = residual_[node] - step * product_[node];
        const Quad<Real> preconditioned = factor.inverse(node) * residual;
        residual_[node] = residual;
        linalg::add_product(residual, preconditioned, product);
        Quad<Real> y = preconditioned + ratio * y_[node];
        if (!coarse_.empty()) y += coarse_r_.displacement[node];
        y_[node] = y;
        p_[node] = y + factor.inverse(node) * sum;
        known_[node] = factor.diagonal(node) * p_[node] - sum;
    });
    return product.sum();
}

template <typename Real>
typename TangentSolver<Real>::Product TangentSolver<Real>::multiply(std::size_t index) {
    const linalg::IncompleteCholesky<Real>& factor = stiffness_.factor();
    std::array<Quad<Real>, ContactNetwork::chunk_particles> sums{};
    stiffness_.add_outer(index, p_, sums.data());
    const Quad<Real> strain = linalg::quad<Real>(p_strain_);
    const Quad<Real> x = linalg::all<0>(strain), y = linalg::all<1>(strain), z = linalg::all<2>(strain);
    linalg::WideQuad curvature, residual, square;
    std::array<linalg::WideQuad, 3> work;
    factor.forward(stiffness_.range(index), sums.data(), [&](std::size_t node, Quad<Real> sum) {
        const std::array<Quad<Real>, 3>& unit = stiffness_.strain_forces(node);
        for (std::size_t axis = 0; axis < 3; ++axis) linalg::add_product(unit[axis], p_[node], work[axis]);
        const Quad<Real> product = known_[node] - sum + unit[0] * x + unit[1] * y + unit[2] * z;
        const Quad<Real> preconditioned = factor.inverse(node) * product;
        product_[node] = product;
        linalg::add_product(y_[node], product, curvature);
        linalg::add_product(residual_[node], preconditioned, residual);
        linalg::add_product(product, preconditioned, square);
        return p_[node] - preconditioned;
    });
    return {curvature.sum(), residual.sum(), square.sum(), Vec3(work[0].sum(), work[1].sum(), work[2].sum())};
}

template <typename Real>
double TangentSolver<Real>::turn(double ratio) {
    p_strain_ = z_strain_ + ratio * p_strain_;
    const Real step = static_cast<Real>(std::exchange(step_, 0.0));
    residual2_ = network_.sum_chunks(0.0, [&](std::size_t index) {
        return linalg::in_widest_registers([&] { return find_direction(index, step, static_cast<Real>(ratio)); });
    });
    product_of_ = network_.sum_chunks(Product(), [&](std::size_t index) {
        return linalg::in_widest_registers([&] { return multiply(index); });
    });
    product_strain_ = allowed_ * (product_of_.strain + stiffness_.of_strain() * p_strain_);
    return product_of_.curvature + p_strain_.dot(product_strain_);
}

template <typename Real>
linalg::CgProgress TangentSolver<Real>::solve(const Eigen::Matrix3d& allowed, const Motion& b, Motion& x,
                                              const std::function<bool(const linalg::CgProgress&)>& done) {
    Largest largest = network_.sum_chunks(Largest(), [&](std::size_t index) {
        const Range range = components(network_, index);
        Largest part;
        for (std::size_t k = range.first; k < range.last; ++k) part.take(b.displacement[k]);
        return part;
    });
    for (const double component : b.strain) largest.take(component);
    const double scale = largest.size;
    if (!std::isfinite(scale)) throw Error("a force on a particle is not a finite number");
    allowed_ = allowed;
    x_strain_ = p_strain_ = z_strain_ = product_strain_ = Vec3::Zero();
    linalg::CgProgress progress;
    if (scale > 0.0) {
        step_ = 0.0;
        product_of_ = {};
        residual2_ = network_.sum_chunks(0.0, [&](std::size_t index) { return start(index, b, scale); });
        residual_strain_ = allowed * b.strain / scale;
        const auto unscaled = [&](linalg::CgProgress scaled) {
            for (double* square : {&scaled.energy, &scaled.error2, &scaled.residual2}) *square *= scale * scale;
            return scaled;
        };
        progress = unscaled(
            linalg::conjugate_gradient(*this, [&](const linalg::CgProgress& so_far) { return done(unscaled(so_far)); }));
    }
    network_.for_chunks([&](std::size_t index) {
        const ContactNetwork::Chunk& chunk = network_.chunks()[index];
        for (std::size_t row = chunk.first_particle; row < chunk.last_particle; ++row) {
            const Quad<Real> moved = scale > 0.0 ? x_[row] + static_cast<Real>(step_) * p_[row] : Quad<Real>{};
            for (std::size_t axis = 0; axis < 3; ++axis)
                x.displacement[3 * row + axis] = scale * static_cast<double>(moved.lanes[axis]);
        }
    });
    x.strain = scale * x_strain_;
    return progress;
}

template class TangentSolver<float>;
template class TangentSolver<double>;

}  // namespace kiln::sintering
