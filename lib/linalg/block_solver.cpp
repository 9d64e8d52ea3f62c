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

/// One pass of conjugate gradients over all fields that are not done. M in single precision is not the same in each iteration, to
/// rounding; directions are made conjugate to the last one by r_(k+1) . z_(k+1) - r_k . z_(k+1) (Polak & Ribiere; Golub & Ye, SIAM
/// J. Sci. Comput. 21 (1999) 1305), which equals the usual r_(k+1) . z_(k+1) for an exact M.
template <int width>
class Pass {
   public:
    Pass(const BlockMatrix& matrix, const Preconditioner<width>& precondition, Batch<width>& x, Batch<width>& r)
        : matrix_(matrix), precondition_(precondition), x_(x), r_(r), q_(r.size(), Values<double, width>::Zero()) {}

    /// left: norms of r; iterations are added to what each report has.
    void run(const PerField<width>& left, const PerField<width>& goal, int max_iterations, const StopRequest& stop,
             std::array<SolveReport, width>& reports) {
        PerField<width> size = left, step, ratio;
        const auto unfinished = [&](int field) {
            return size[field] > goal[field] && reports[static_cast<std::size_t>(field)].iterations < max_iterations;
        };
        std::array<bool, width> active;
        for (int field = 0; field < width; ++field) active[static_cast<std::size_t>(field)] = unfinished(field);
        precondition_(r_, z_);
        PerField<width> product = products().rz;
        p_ = z_;
        while (true) {
            throw_if_stopped(stop);
            const PerField<width> curvature = multiply_and_dot<width>(matrix_, p_, q_);
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
            precondition_(r_, z_);
            const Products<width> next = products();
            for (int field = 0; field < width; ++field) {
                const bool on = active[static_cast<std::size_t>(field)];
                ratio[field] = on ? -step[field] * next.qz[field] / product[field] : 0.0;
            }
            product = next.rz;
            turn(ratio);
        }
    }

   private:
    /// x += step p, r -= step q; gives the norms of r.
    PerField<width> advance(const PerField<width>& step) {
        const auto factors = step.matrix().asDiagonal();
        return sum_over_chunks<width>(x_.size(), [&](std::size_t first, std::size_t last) {
            PerField<width> sum = PerField<width>::Zero();
            for (std::size_t i = first; i < last; ++i) {
                x_[i] += p_[i] * factors;
                r_[i] -= q_[i] * factors;
                sum += r_[i].colwise().squaredNorm().array();
            }
            return sum;
        }).sqrt();
    }

    Products<width> products() const {
        constexpr std::size_t in_chunk = 1024;
        const Products<width> zero{PerField<width>::Zero(), PerField<width>::Zero()};
        return sum_chunks((r_.size() + in_chunk - 1) / in_chunk, zero, [&](std::size_t chunk) {
            Products<width> sum = zero;
            for (std::size_t i = chunk * in_chunk; i < std::min(r_.size(), (chunk + 1) * in_chunk); ++i) {
                sum.rz += r_[i].cwiseProduct(z_[i]).colwise().sum().array();
                sum.qz += q_[i].cwiseProduct(z_[i]).colwise().sum().array();
            }
            return sum;
        });
    }

    /// p = z + ratio p.
    void turn(const PerField<width>& ratio) {
        const auto factors = ratio.matrix().asDiagonal();
        for_rows(p_.size(), [&](std::size_t i) { p_[i] = z_[i] + p_[i] * factors; }, worth_threads);
    }

    const BlockMatrix& matrix_;
    const Preconditioner<width>& precondition_;
    Batch<width>&x_, &r_;
    Batch<width> z_, p_, q_;
};

}  // namespace

template <int width>
std::array<SolveReport, width> solve_blocks(const BlockMatrix& matrix, const Preconditioner<width>& precondition,
                                            const Batch<width>& b, Batch<width>& x, double tolerance, int max_iterations,
                                            const StopRequest& stop) {
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
        Pass<width>(matrix, precondition, x, r).run(left, goal, max_iterations, stop, reports);
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

template std::array<SolveReport, 1> solve_blocks<1>(const BlockMatrix&, const Preconditioner<1>&, const Batch<1>&, Batch<1>&,
                                                    double, int, const StopRequest&);
template std::array<SolveReport, 6> solve_blocks<6>(const BlockMatrix&, const Preconditioner<6>&, const Batch<6>&, Batch<6>&,
                                                    double, int, const StopRequest&);

}  // namespace kiln::linalg
