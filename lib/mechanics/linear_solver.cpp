// linear_solver.cpp: solves by an iteration of someone else, judged by the residual.
#include "mechanics/linear_solver.h"

#include <cmath>

namespace kiln::mechanics {

namespace {

constexpr int max_passes = 5;  // each takes what the one before has left

}  // namespace

linalg::SolveReport solve_with(LinearSolver& solver, const Residual& residual, const Vector& load, Vector& x, double tolerance,
                               int max_iterations) {
    linalg::SolveReport report;
    const double size = linalg::norm(load);
    Vector r, step;
    if (x.empty()) {
        x.assign(load.size(), Vec6::Zero());
        r = load;
    } else {
        residual(x, load, r);
    }
    double left = linalg::norm(r);
    for (int pass = 0; pass < max_passes && left > tolerance * size && report.iterations < max_iterations; ++pass) {
        report.iterations += solver.solve(r, step, tolerance * size / left, max_iterations - report.iterations);
        linalg::add(1.0, step, x);
        residual(x, load, r);
        left = linalg::norm(r);
        if (!std::isfinite(left)) throw Error("a linear solve meets a number that is not finite");
    }
    report.residual = size > 0.0 ? left / size : 0.0;
    report.converged = left <= tolerance * size;
    return report;
}

std::array<linalg::SolveReport, 3> solve_with(LinearSolver& solver, const Residual& residual, const linalg::Batch<3>& load,
                                              linalg::Batch<3>& x, double tolerance, int max_iterations) {
    std::array<linalg::SolveReport, 3> reports;
    const bool from_zero = x.empty();
    x.resize(load.size());
    for (int field = 0; field < 3; ++field) {
        Vector b(load.size()), found(from_zero ? 0 : load.size());
        for (std::size_t node = 0; node < b.size(); ++node) b[node] = load[node].col(field);
        for (std::size_t node = 0; node < found.size(); ++node) found[node] = x[node].col(field);
        reports[static_cast<std::size_t>(field)] = solve_with(solver, residual, b, found, tolerance, max_iterations);
        for (std::size_t node = 0; node < found.size(); ++node) x[node].col(field) = found[node];
    }
    return reports;
}

}  // namespace kiln::mechanics
