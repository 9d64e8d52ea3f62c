// block_solver.cpp: conjugate gradients in lock-step for the fields of a batch, and the residuals that judge them.
#include "linalg/block_solver.h"

#include <cmath>

#include "core/types.h"

namespace kiln::linalg {

namespace {

constexpr int max_restarts = 3;  // with the residual as it is; each takes what rounding left of the one before

/// r . z and q . z of each field.
template <int width>
struct Products {
    PerField<width> rz, qz;

    Products& operator+=(const Products& other) {
        rz += other.rz;
        qz += other.qz;
        return *this;
    }
};

template <int width>
PerField<width> sums(const Values<double, width>& values) { return values.colwise().sum().array(); }

/// One pass of conjugate gradients over all fields that are not done. M in single precision is not the same in each iteration, to
/// rounding; directions are made conjugate to the last one by r_(k+1) . z_(k+1) - r_k . z_(k+1) (Polak & Ribiere; Golub & Ye, SIAM
/// J. Sci. Comput. 21 (1999) 1305), which equals the usual r_(k+1) . z_(k+1) for an exact M. Directions are kept in single
/// precision too, in a unit of their own: x and r follow them as they are.
template <int width>
class Pass {
   public:
    Pass(const Springs<double>& matrix, Multigrid& preconditioner, Batch<width>& x, Batch<width>& r)
        : matrix_(matrix), preconditioner_(preconditioner), x_(x), r_(r), q_(r.size()), p_(r.size()) {}

    /// left: norms of r; iterations are added to what each report has.
    void run(const PerField<width>& left, const PerField<width>& goal, int max_iterations, const StopRequest& stop,
             std::array<SolveReport, width>& reports) {
        PerField<width> size = left, step, ratio = PerField<width>::Zero();
        const auto unfinished = [&](int field) {
            return size[field] > goal[field] && reports[static_cast<std::size_t>(field)].iterations < max_iterations;
        };
        std::array<bool, width> active;
        for (int field = 0; field < width; ++field) active[static_cast<std::size_t>(field)] = unfinished(field);
        const auto first = preconditioner_.apply<width>(r_, size);
        const PerField<width> unit = (first.unit > 0.0).select(first.unit, 1.0);
        PerField<width> product = products(first.motion, PerField<width>::Ones()).rz;
        turn(first.motion, PerField<width>::Ones(), ratio);
        while (true) {
            throw_if_stopped(stop);
            const PerField<width> curvature = multiply();
            bool any = false;
            for (int field = 0; field < width; ++field) {
                bool& on = active[static_cast<std::size_t>(field)];
                step[field] = 0.0;
                if (!on) continue;
                if (!std::isfinite(product[field]) || !std::isfinite(curvature[field]))
                    throw Error("a linear solve meets a number that is not finite");
                on = curvature[field] > 0.0;  // otherwise only motion that costs nothing is left
                if (!on) continue;
                step[field] = product[field] / curvature[field];
                ++reports[static_cast<std::size_t>(field)].iterations;
                any = true;
            }
            if (!any) return;
            size = advance(step);
            any = false;
            for (int field = 0; field < width; ++field) {
                bool& on = active[static_cast<std::size_t>(field)];
                on = on && unfinished(field);
                any = any || on;
            }
            if (!any) return;
            throw_if_stopped(stop);
            const auto z = preconditioner_.apply<width>(r_, size);
            const PerField<width> factor = z.unit / unit;
            const Products<width> next = products(z.motion, factor);
            for (int field = 0; field < width; ++field) {
                const bool on = active[static_cast<std::size_t>(field)];
                ratio[field] = on ? -step[field] * next.qz[field] / product[field] : 0.0;
            }
            product = next.rz;
            turn(z.motion, factor, ratio);
        }
    }

   private:
    using Motions = std::vector<Freedoms<float, width>>;

    /// q = A p; gives p . q.
    PerField<width> multiply() {
        return sum_chunks(matrix_.chunks(), PerField<width>(PerField<width>::Zero()), [&](std::size_t chunk) {
            PerField<width> sum = PerField<width>::Zero();
            matrix_.for_forces<width>(chunk, p_, [&](std::size_t node, const Freedoms<double, width>& force) {
                q_[node] = values_of(force);
                sum += sums<width>(q_[node].cwiseProduct(values_of(p_[node])));
            });
            return sum;
        });
    }

    /// x += step p, r -= step q; gives the norms of r.
    PerField<width> advance(const PerField<width>& step) {
        const auto factors = step.matrix().asDiagonal();
        return sum_over_chunks<width>(x_.size(), [&](std::size_t first, std::size_t last) {
            PerField<width> sum = PerField<width>::Zero();
            for (std::size_t i = first; i < last; ++i) {
                x_[i] += values_of(p_[i]) * factors;
                r_[i] -= q_[i] * factors;
                sum += r_[i].colwise().squaredNorm().array();
            }
            return sum;
        }).sqrt();
    }

    /// z: in units of p times the factor.
    Products<width> products(const Motions& z, const PerField<width>& factor) const {
        constexpr std::size_t in_chunk = 1024;
        const Products<width> zero{PerField<width>::Zero(), PerField<width>::Zero()};
        Products<width> total = sum_chunks((r_.size() + in_chunk - 1) / in_chunk, zero, [&](std::size_t chunk) {
            Products<width> sum = zero;
            for (std::size_t i = chunk * in_chunk; i < std::min(r_.size(), (chunk + 1) * in_chunk); ++i) {
                const Values<double, width> values = values_of(z[i]);
                sum.rz += sums<width>(r_[i].cwiseProduct(values));
                sum.qz += sums<width>(q_[i].cwiseProduct(values));
            }
            return sum;
        });
        total.rz *= factor;
        total.qz *= factor;
        return total;
    }

    /// p = factor z + ratio p.
    void turn(const Motions& z, const PerField<width>& factor, const PerField<width>& ratio) {
        const auto factors = factor.matrix().asDiagonal(), ratios = ratio.matrix().asDiagonal();
        for_rows(
            p_.size(),
            [&](std::size_t i) {
                p_[i] = motion_of<float, width>(Values<double, width>(values_of(z[i]) * factors + values_of(p_[i]) * ratios));
            },
            worth_threads);
    }

    const Springs<double>& matrix_;
    Multigrid& preconditioner_;
    Batch<width>&x_, &r_;
    Batch<width> q_;
    Motions p_;
};

}  // namespace

template <int width>
std::array<SolveReport, width> solve_springs(const Springs<double>& matrix, Multigrid& preconditioner, const Batch<width>& b,
                                             Batch<width>& x, double tolerance, int max_iterations, const StopRequest& stop) {
    std::array<SolveReport, width> reports;
    const PerField<width> size = norms<width>(b), goal = tolerance * size;
    Batch<width> r;
    if (x.empty()) {
        x.resize(b.size(), Values<double, width>::Zero());
        r = b;
    } else {
        residual<width>(matrix, x, b, r);
    }
    PerField<width> left = norms<width>(r);
    const auto unfinished = [&] {
        bool any = false;
        for (int field = 0; field < width; ++field)
            any = any || (left[field] > goal[field] && reports[static_cast<std::size_t>(field)].iterations < max_iterations);
        return any;
    };
    for (int pass = 0; pass <= max_restarts && unfinished(); ++pass) {
        Pass<width>(matrix, preconditioner, x, r).run(left, goal, max_iterations, stop, reports);
        residual<width>(matrix, x, b, r);
        left = norms<width>(r);
    }
    for (int field = 0; field < width; ++field) {
        SolveReport& report = reports[static_cast<std::size_t>(field)];
        report.residual = size[field] > 0.0 ? left[field] / size[field] : 0.0;
        report.converged = left[field] <= goal[field];
    }
    return reports;
}

int solve_roughly(const Springs<double>& matrix, Multigrid& preconditioner, const Vector& b, Vector& x, Vector& r, double tolerance,
                  int max_iterations, const StopRequest& stop) {
    std::array<SolveReport, 1> reports;
    x.assign(b.size(), Vec6::Zero());
    r = b;
    const PerField<1> size = norms<1>(b), goal = tolerance * size;
    if (size[0] > goal[0]) Pass<1>(matrix, preconditioner, x, r).run(size, goal, max_iterations, stop, reports);
    return reports[0].iterations;
}

template std::array<SolveReport, 1> solve_springs<1>(const Springs<double>&, Multigrid&, const Batch<1>&, Batch<1>&, double, int,
                                                     const StopRequest&);
template std::array<SolveReport, 3> solve_springs<3>(const Springs<double>&, Multigrid&, const Batch<3>&, Batch<3>&, double, int,
                                                     const StopRequest&);

}  // namespace kiln::linalg
