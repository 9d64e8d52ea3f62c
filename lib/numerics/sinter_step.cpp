// sinter_step.cpp: Newton with a line search on the step's convex function, first at the start geometry, then at the midpoint.
#include "numerics/sinter_step.h"

#include <algorithm>
#include <cmath>

#include "core/contacts.h"

namespace kiln::numerics {

namespace {

constexpr int most_newton = 60;
constexpr int most_searches = 12;
constexpr int most_conjugate_gradients = 5000;
constexpr double overshoot = 0.5;          // slope left at the end of a Newton step, relative to its start, that asks for a line search
constexpr double least_tangent = 0.1;      // of the tangent at a pair's own end of the step
constexpr double loosest_linear = 0.1;     // tolerance of the linear solves, loosest and tightest
constexpr double tightest_linear = 1e-3;
constexpr double predictor_tolerance = 10.0;  // of the first-order solution, over that of the step
constexpr double corrector_linear = 0.05;  // tolerance of the first linear solve that starts from the first-order solution

/// Share of the step in which a pair touches, by linear change of the overlap.
double touching_share(double start, double end) {
    if (start >= 0.0 && end >= 0.0) return 1.0;
    if (start < 0.0 && end < 0.0) return 0.0;
    return std::max(start, end) / std::abs(end - start);
}

/// Overlap at the end of the step of a pair that nothing else holds, under its share of the sintering force, m.
double alone(const PairStep& pair, double share) {
    const double start = std::max(0.0, pair.overlap);
    return std::cbrt(start * start * start + 3.0 * share * pair.force / pair.cubic);
}

}  // namespace

SinterStep::SinterStep(const Box& box, std::span<const Vec3> position, std::span<const Pair> pairs, const StepSettings& settings)
    : box_(box),
      pairs_(pairs),
      settings_(settings),
      network_(box, position, pairs),
      solver_(position.size()),
      preconditioner_(network_),
      normals_(pairs.size()),
      vectors_(pairs.size()),
      share_(pairs.size()),
      tangential_(pairs.size()),
      total_(3 * position.size()),
      unbalanced_(position.size()),
      direction_(position.size()) {}

Vec3 SinterStep::relative(std::size_t row, const Motion& motion, const Vec3& vector) const {
    const Eigen::Map<const Vec3> a(&motion.displacement[3 * static_cast<std::size_t>(pairs_[row].i)]);
    const Eigen::Map<const Vec3> b(&motion.displacement[3 * static_cast<std::size_t>(pairs_[row].j)]);
    return b - a + motion.strain.cwiseProduct(vector);
}

void SinterStep::start_geometry(const std::vector<PairStep>& step) {
#pragma omp parallel for schedule(static)
    for (std::size_t row = 0; row < step.size(); ++row) {
        const PairStep& pair = step[row];
        vectors_[row] = pair.vector;
        normals_[row] = pair.vector / pair.distance;
        share_[row] = pair.overlap >= 0.0 ? 1.0 : 0.0;
        // Mean overlap of the step as the pair alone would have it: at its start a new contact has no neck to resist shear.
        const double mean_overlap = share_[row] * 0.5 * (pair.overlap + alone(pair, share_[row]));
        tangential_[row] = physics::tangential_viscosity(settings_.constants, mean_overlap, pair.reduced_radius) / pair.diffusion;
    }
}

void SinterStep::midpoint_geometry(const std::vector<PairStep>& step, const Motion& motion) {
#pragma omp parallel for schedule(static)
    for (std::size_t row = 0; row < step.size(); ++row) {
        const PairStep& pair = step[row];
        const Vec3 end = pair.vector + relative(row, motion, pair.vector);
        const double end_overlap = pair.overlap + pair.distance - end.norm();
        normals_[row] = (pair.vector + end).normalized();
        share_[row] = touching_share(pair.overlap, end_overlap);
        const double mean_overlap = 0.5 * (std::max(pair.overlap, 0.0) + std::max(end_overlap, 0.0)) * share_[row];
        tangential_[row] = physics::tangential_viscosity(settings_.constants, mean_overlap, pair.reduced_radius) / pair.diffusion;
    }
}

void SinterStep::forces(const std::vector<PairStep>& step, const Motion& motion, Motion& unbalanced, bool secant) {
    ContactNetwork& network = network_;
    network.for_chunks([&](std::size_t index) {
        const ContactNetwork::Chunk& chunk = network.chunks()[index];
        for (std::size_t entry = chunk.begin; entry < chunk.end; ++entry) {
            const auto row = static_cast<std::size_t>(network.pair[entry]);
            network.nx[entry] = normals_[row][0];
            network.ny[entry] = normals_[row][1];
            network.nz[entry] = normals_[row][2];
            network.tangential[entry] = tangential_[row];
        }
    });
    network.gather(motion, unbalanced, total_, [&](std::size_t entry, const Vec3& du) -> Vec3 {
        const auto row = static_cast<std::size_t>(network.pair[entry]);
        const PairStep& pair = step[row];
        const Vec3& n = normals_[row];
        const double along = n.dot(du);  // opening
        const double start = std::max(0.0, pair.overlap), reached = std::max(0.0, pair.overlap - along);
        const double force = share_[row] * pair.force;
        const double resistance = pair.cubic / 3.0 * (reached * reached * reached - start * start * start);
        // A contact that has hardly closed has no tangent yet: take the secant towards where the pair alone would end, or at least a
        // part of the tangent there.
        const double goal = alone(pair, share_[row]);
        const double least = secant ? (goal * goal + goal * reached + reached * reached) / 3.0 : least_tangent * goal * goal;
        network.normal[entry] = pair.cubic * std::max(reached * reached, reached < goal ? least : 0.0);
        return (force - resistance) * n + tangential_[row] * (du - along * n);
    });
    for (int axis = 0; axis < 3; ++axis) unbalanced.strain[axis] += settings_.pressure[axis] * box_.volume();
    project(unbalanced, settings_.allowed_strain);
    work_ = network.sum_chunks([&](std::size_t index) {
        double sum = 0.0;
        network.for_owned(index, [&](std::size_t entry) {
            const auto row = static_cast<std::size_t>(network.pair[entry]);
            sum -= share_[row] * step[row].force * normals_[row].dot(relative(row, motion, vectors_[row]));
        });
        return sum;
    }) - settings_.pressure.dot(motion.strain) * box_.volume();
}

double SinterStep::line_search(const std::vector<PairStep>& step, double slope, Motion& motion) {
    double length = 1.0, low = 0.0, low_slope = -slope, high = 1.0, high_slope = dot(network_, unbalanced_, direction_);
    if (high_slope <= overshoot * slope) return length;
    for (int search = 0; search < most_searches; ++search) {  // regula falsi on the slope; a convex function has one zero of it
        const double share = std::clamp(-low_slope / (high_slope - low_slope), 0.1, 0.9);
        const double next = low + share * (high - low);
        add(network_, next - length, direction_, motion);
        length = next;
        forces(step, motion, unbalanced_, false);
        const double left = dot(network_, unbalanced_, direction_);
        if (std::abs(left) <= overshoot * slope) break;
        if (left > 0.0) {
            high = length;
            high_slope = left;
        } else {
            low = length;
            low_slope = left;
            high_slope *= 0.5;  // an end that stays counts half, else the other end hardly moves
        }
    }
    return length;
}

bool SinterStep::newton(const std::vector<PairStep>& step, double tolerance, double linear_tolerance, Motion& motion,
                        StepReport& report) {
    forces(step, motion, unbalanced_, true);
    for (int iteration = 0; iteration < most_newton; ++iteration) {
        preconditioner_.factorise(network_, vectors_);
        unbalanced_.strain *= -1.0;
        for (double& component : unbalanced_.displacement) component = -component;
        const LinearSolve linear = solver_.solve(network_, preconditioner_, settings_.allowed_strain, unbalanced_, direction_, linear_tolerance,
                                                 most_conjugate_gradients);
        ++report.newton;
        report.conjugate_gradients += linear.iterations;
        const double slope = dot(network_, unbalanced_, direction_);  // minus the derivative along the direction
        if (!(slope > 0.0)) return true;
        add(network_, 1.0, direction_, motion);
        forces(step, motion, unbalanced_, false);
        const double length = line_search(step, slope, motion);
        const double error = std::sqrt(slope / std::max(work_, slope));  // of the motion before this iteration, energy norm
        const double now = length < 1.0 ? error : (linear.residual + error) * error;
        if (now < tolerance) return true;
        linear_tolerance = std::clamp(std::max(now, 0.5 * tolerance / now), tightest_linear, loosest_linear);
    }
    return false;
}

void SinterStep::remove_drift(const std::vector<PairStep>& step, Motion& motion) const {
    const std::size_t count = network_.particles();
    Clusters clusters(count);
    for (std::size_t row = 0; row < pairs_.size(); ++row) {
        if (share_[row] > 0.0 || step[row].overlap > 0.0) clusters.join(pairs_[row].i, pairs_[row].j);
    }
    std::vector<Vec3> drift(count, Vec3::Zero());
    std::vector<double> members(count, 0.0);
    for (std::size_t row = 0; row < count; ++row) {
        const auto cluster = static_cast<std::size_t>(clusters.root(static_cast<std::int32_t>(row)));
        drift[cluster] += Eigen::Map<const Vec3>(&motion.displacement[3 * row]);
        members[cluster] += 1.0;
    }
    for (std::size_t row = 0; row < count; ++row) {
        const auto cluster = static_cast<std::size_t>(clusters.root(static_cast<std::int32_t>(row)));
        Eigen::Map<Vec3>(&motion.displacement[3 * row]) -= drift[cluster] / members[cluster];
    }
}

StepReport SinterStep::solve(const std::vector<PairStep>& step, Motion& motion, Motion& first_order) {
    StepReport report;
    motion = Motion(network_.particles());
    start_geometry(step);
    report.converged = newton(step, predictor_tolerance * settings_.solver_tolerance, loosest_linear, motion, report);
    remove_drift(step, motion);
    first_order = motion;
    if (!settings_.second_order) return report;
    midpoint_geometry(step, motion);
    report.converged = newton(step, settings_.solver_tolerance, corrector_linear, motion, report) && report.converged;
    remove_drift(step, motion);
    return report;
}

}  // namespace kiln::numerics
