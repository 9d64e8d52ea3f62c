// sinter_step.cpp: Newton with a line search on the step's convex function, first at the start geometry, then at the midpoint.
#include "sintering/sinter_step.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "core/contacts.h"
#include "physics/sinter_contact.h"
#include "sintering/few_particles.h"
#include "sintering/force_balance.h"

namespace kiln::sintering {

namespace {

constexpr int max_newton = 60;
constexpr int max_searches = 12;
constexpr int max_conjugate_gradients = 5000;
constexpr double rounding = 1e-6;          // error of a motion below which a direction that leads nowhere is made of rounding
constexpr double overshoot = 0.5;  // slope left at the end of a Newton step, relative to its start, that asks for a line search
constexpr double min_tangent = 0.1;        // of the tangent at a pair's own end of the step
constexpr double max_linear = 0.1;         // error of the linear solves, loosest and tightest
constexpr double min_linear = 1e-3;
constexpr double surprise = 4.0;   // error over what the iteration before foretold, from which linear solves are held to have ended
constexpr double closer = 0.1;     // too early: the next ones go closer by this factor
constexpr double linear_fraction = 0.5;    // of the tolerance, that is left to linear solves
constexpr double imbalance_factor = 15.0;  // times the tolerance, forces left on a single particle, where the tolerance is for all:
constexpr double min_single = 1e-3;        // a tenth of it is typical; within these bounds
constexpr double max_single = 0.5;
constexpr double few = 1e-3;               // of the particles, that are moved alone where only they are out of balance
constexpr double min_progress = 0.7;       // of what is left on the worst, below which moving them alone was worth it
constexpr double sharpening = 0.5;         // of what linear solves may leave, where that still unbalances a particle
constexpr double limit_stiffness = 10.0;   // of the springs at limits of rigid particles, over the mean tangent of the contacts
constexpr double limit_accuracy = 1e-7;    // of the reduced radius, to which a limit of approach is met
constexpr int max_limit_passes = 60;
constexpr double coarse_contrast = 30.0;   // of diffusion, that makes a coarse space pay
constexpr double single_contrast = 100.0;  // of diffusion, up to which single precision resolves the soft contacts beside the stiff

double square(double x) { return x * x; }

/// Share of the step in which a pair touches, by linear change of the overlap.
double touching_fraction(double start, double end) {
    if (start >= 0.0 && end >= 0.0) return 1.0;
    if (start < 0.0 && end < 0.0) return 0.0;
    return std::max(start, end) / std::abs(end - start);
}

/// Force by which the viscosity of a contact resists an approach over the step; cubic: K/I.
template <typename Number>
Number pair_resistance(Number cubic, Number overlap, Number approach) {
    const Number start = physics::positive(overlap), reached = physics::positive(overlap + approach), zero{};
    // While both touch the approach is taken as it is: the difference of overlaps would be the rounding of a slow contact's.
    const Number difference = reached - start, change = (overlap > zero) & (reached > zero) ? approach : difference;
    return cubic * physics::mean_viscosity_shape(start, reached) * change;
}

double slowest_of(std::span<const PairStep> step) {
    return greatest_of_rows(step.size(), 0.0, [&](std::size_t row) { return step[row].slowness; });
}

/// Coarse spaces of the pairs that touch; one that does not touch yet ties nothing.
std::vector<RigidClusters> coarse_spaces_of(const Box& box, std::span<const Vec3> position, std::span<const Pair> pairs,
                                            std::span<const PairStep> step, double slowest) {
    if (slowest < coarse_contrast) return {};
    std::vector<double> slowness;
    slowness.reserve(step.size());
    for (const PairStep& pair : step) slowness.push_back(pair.overlap >= 0.0 ? pair.slowness : 0.0);
    return coarse_spaces(box, position, pairs, slowness, coarse_contrast);
}

}  // namespace

SinterStep::SinterStep(const Box& box, std::span<const Vec3> position, std::span<const Pair> pairs, std::span<const PairStep> step,
                       const StepSettings& settings)
    : box_(box),
      pairs_(pairs),
      step_(step),
      settings_(settings),
      network_(box, position, pairs),
      slowest_(slowest_of(step)),
      coarse_(coarse_spaces_of(box, position, pairs, step, slowest_)),
      entries_(std::make_unique_for_overwrite<PairForce[]>(network_.pair.size())),
      alone_(std::make_unique_for_overwrite<double[]>(pairs.size())),
      resisting_(std::make_unique_for_overwrite<double[]>(network_.pair.size())),
      branch_(step.size()),
      total_(position.size()),
      driving_forces_(position.size()),
      unbalanced_(position.size()),
      direction_(position.size()) {
    for_rows(step.size(), [&](std::size_t row) {
        const PairStep& pair = step[row];
        branch_[row] = pair.branch;
        alone_[row] = pair.cubic > 0.0 ? physics::overlap_of_integral(pair.overlap, pair.force / pair.cubic) : 0.0;
    });
    limited_ = join_rows(step.size(), false, [&](std::size_t row) { return !std::isinf(step[row].limit); }, std::logical_or());
    if (slowest_ <= single_contrast)
        solver_ = std::make_unique<TangentSolver<float>>(box, network_, pairs, coarse_);
    else
        solver_ = std::make_unique<TangentSolver<double>>(box, network_, pairs, coarse_);
}

Vec3 SinterStep::relative(std::size_t row, const Motion& motion) const {
    const Eigen::Map<const Vec3> a(&motion.displacement[3 * static_cast<std::size_t>(pairs_[row].i)]);
    const Eigen::Map<const Vec3> b(&motion.displacement[3 * static_cast<std::size_t>(pairs_[row].j)]);
    return b - a + motion.strain.cwiseProduct(branch_[row]);
}

double SinterStep::isolated_end(std::size_t row, double fraction) const {
    const PairStep& pair = step_[row];
    if (fraction == 1.0 || !(pair.cubic > 0.0)) return alone_[row];
    return physics::overlap_of_integral(pair.overlap, fraction * pair.force / pair.cubic);
}

inline SinterStep::PairForce SinterStep::pair_force(std::size_t row, const Vec3& normal, double fraction, double isolated_end,
                                                    double end_overlap) const {
    const PairStep& pair = step_[row];
    const double mean_overlap = 0.5 * (std::max(pair.overlap, 0.0) + std::max(end_overlap, 0.0));
    return {normal, pair.overlap, pair.cubic, isolated_end, fraction * pair.force, pair.shear * fraction * mean_overlap};
}

void SinterStep::start_geometry() {
    pressure_volume_ = settings_.pressure * box_.volume();
    take_geometry(Motion(network_.particles()), [&](std::size_t row, const Vec3&) {
        const PairStep& pair = step_[row];
        const double fraction = pair.overlap >= 0.0 ? 1.0 : 0.0, end = isolated_end(row, fraction);
        // Shear by the overlap that the pair alone would come to: at the start of the step a new contact has no neck to resist.
        return pair_force(row, pair.vector / pair.distance, fraction, end, end);
    });
}

void SinterStep::midpoint_geometry(const Motion& motion) {
    const Vec3 stretch = Vec3::Ones() + 0.5 * motion.strain;  // the pressure acts on the faces of the box as they are half way
    pressure_volume_ = settings_.pressure * box_.volume() * stretch.prod();
    pressure_volume_ = pressure_volume_.cwiseQuotient(stretch);
    take_geometry(motion, [&](std::size_t row, const Vec3& du) {
        const PairStep& pair = step_[row];
        const Vec3 end = pair.vector + du;
        const double end_overlap = pair.overlap + pair.distance - end.norm();
        const double fraction = touching_fraction(pair.overlap, end_overlap);
        return pair_force(row, (pair.vector + end).normalized(), fraction, isolated_end(row, fraction), end_overlap);
    });
}

/// Takes what does not change between Newton's iterations: force_of(pair, its relative motion).
template <typename ForceOf>
void SinterStep::take_geometry(const Motion& motion, const ForceOf& force_of) {
    std::visit([&](auto& solver) {
        network_.gather(motion, driving_forces_, total_, [&](std::size_t entry, const Vec3& du) -> Vec3 {
            const PairForce pair = force_of(static_cast<std::size_t>(network_.pair[entry]), du);
            entries_[entry] = pair;
            solver->springs().set_direction(entry, pair.normal);
            return pair.driving * pair.normal;
        });
    }, solver_);
    start_limits();
}

void SinterStep::start_limits() {
    if (!limited_) return;
    double stiffness = 0.0;
    for (std::size_t row = 0; row < step_.size(); ++row) {
        const PairForce& pair = force_of(row);
        stiffness += pair.driving > 0.0 ? pair.cubic * physics::viscosity_shape(pair.isolated_end) : 0.0;
    }
    const double spring = limit_stiffness * stiffness / static_cast<double>(std::max<std::size_t>(step_.size(), 1));
    limits_.reset(step_.size());
    for (std::size_t row = 0; row < step_.size(); ++row) {
        const PairStep& pair = step_[row];
        if (std::isinf(pair.limit)) continue;
        const double start = std::max(0.0, pair.overlap), reached = std::max(0.0, pair.overlap + pair.limit);
        const bool yields = pair.spring > 0.0;
        const double alone =  // force at the limit if nothing else held the pair
            std::max(0.0, force_of(row).driving - pair.cubic * physics::viscosity_integral(start, reached));
        limits_.add(row, pair.limit, yields ? 0.0 : alone, yields ? pair.spring : spring);
    }
}

template <bool limited, typename Real>
void SinterStep::forces(TangentSolver<Real>& solver, const Motion& motion, bool secant) {
    using Lanes = linalg::WideQuad::Lanes;
    const auto columns_at = [](const double* first, std::size_t stride, std::size_t last) {
        const auto row = [&](std::size_t k) { return linalg::load(first + stride * std::min(k, last)).lanes; };
        return FourByFour{row(0), row(1), row(2), row(3)}.transposed();
    };
    network_.gather(motion, unbalanced_, total_, [&](std::size_t entry, std::size_t count, const Fours& du) -> Fours {
        constexpr std::size_t stride = sizeof(PairForce) / sizeof(double);
        const double* const pairs = entries_[entry].normal.data();
        const auto [x, y, z, overlap] = columns_at(pairs, stride, count - 1);
        const auto [cubic, isolated_end, driving, tangential] = columns_at(pairs + 4, stride, count - 1);
        const Lanes along = x * du.x + y * du.y + z * du.z;  // opening
        const Lanes reached = physics::positive(overlap - along), zero{};
        const Lanes resistance = pair_resistance(cubic, overlap, -along);
        // A contact that has hardly closed has no tangent yet: take the secant towards where the pair alone would end, or at least
        // a part of the tangent there.
        const Lanes least = secant ? physics::mean_viscosity_shape(isolated_end, reached)
                                   : min_tangent * physics::viscosity_shape(isolated_end);
        const Lanes shape = physics::viscosity_shape(reached);
        const Lanes floor = (reached < isolated_end) & (least > shape) ? least : shape;
        Lanes tangent = cubic * floor, limit{};
        if constexpr (limited)
            for (std::size_t k = 0; k < count; ++k) {
                const auto row = static_cast<std::size_t>(network_.pair[entry + k]);
                const double held = limits_.tangent(row, -along[k], driving[k] - resistance[k]);
                limit[k] = limits_.reaction(row, -along[k]);
                tangent[k] = limit[k] > 0.0 ? tangent[k] + held : std::max(tangent[k], held);
            }
        const Lanes resisting = (resistance < zero ? -resistance : resistance) + limit;
        for (std::size_t k = 0; k < count; ++k) {
            resisting_[entry + k] = resisting[k];
            solver.springs().set(entry + k, tangent[k], tangential[k]);
        }
        const Lanes normal_force = driving - resistance - limit - tangential * along;
        return {normal_force * x + tangential * du.x, normal_force * y + tangential * du.y,
                normal_force * z + tangential * du.z};
    });
}

void SinterStep::forces(const Motion& motion, bool secant) {
    std::visit([&](auto& solver) {
        if (limits_.any()) forces<true>(*solver, motion, secant);
        else forces<false>(*solver, motion, secant);
    }, solver_);
    strain_force_ = unbalanced_.strain;
    unbalanced_.strain += pressure_volume_;
    project(unbalanced_, settings_.allowed_strain);
    work_ = -dot(network_, driving_forces_, motion) - pressure_volume_.dot(motion.strain);
    if (!std::isfinite(work_)) throw Error("a step of sintering meets a force that is not a finite number");
}

/// Of a pair that touches for a part of the step the whole sintering force counts: the part may be next to nothing.
SinterStep::Exerted SinterStep::exerted() const {
    Exerted result{std::vector<double>(step_.size())};
    result.on_box = network_.sum_chunks<Vec3>(pressure_volume_.cwiseAbs(), [&](std::size_t chunk) {
        Vec3 part = Vec3::Zero();
        network_.for_owned(chunk, [&](std::size_t entry) {
            const auto row = static_cast<std::size_t>(network_.pair[entry]);
            result.by_pair[row] = step_[row].force + resisting_[entry];
            part += result.by_pair[row] * entries_[entry].normal.cwiseProduct(branch_[row]).cwiseAbs();
        });
        return part;
    });
    return result;
}

double SinterStep::imbalance() const {
    const Exerted exerted = this->exerted();
    // On the box: what its axes share out among those that strain together.
    const Vec3 on_box = settings_.allowed_strain.cwiseAbs() * exerted.on_box;
    double worst = max_imbalance(network_, pairs_, exerted.by_pair, coarse_, unbalanced_);
    const auto judge_box = [&](const Vec3& left) {
        for (int axis = 0; axis < 3; ++axis)
            if (left[axis] != 0.0) worst = std::max(worst, std::abs(left[axis]) / on_box[axis]);
    };
    judge_box(unbalanced_.strain);
    for (const RigidClusters& clusters : coarse_)  // the box as it strains with clusters that move as one
        judge_box(settings_.allowed_strain * clusters.node_forces(unbalanced_).strain);
    return worst;
}

/// The particles that are out of balance by more than the limit, if they are few.
std::vector<std::size_t> SinterStep::few_unbalanced(double limit) const {
    if (!coarse_.empty()) return {};  // clusters may be out of balance as well
    std::vector<std::size_t> particles = unbalanced_particles(network_, exerted().by_pair, limit, unbalanced_);
    if (static_cast<double>(particles.size()) > few * static_cast<double>(network_.particles())) particles.clear();
    return particles;
}

/// The direction in which these and their neighbours are balanced.
void SinterStep::relax(const std::vector<std::size_t>& particles) {
    std::visit([&](auto& solver) {
        const auto stiffness = [&](std::size_t entry) { return solver->springs().spring(entry).block(); };
        relax_few(network_, stiffness, particles, unbalanced_, direction_);
    }, solver_);
}

double SinterStep::line_search(double slope, Motion& motion) {
    double length = 1.0, low = 0.0, low_slope = -slope, high = 1.0, high_slope = -dot(network_, unbalanced_, direction_);
    if (high_slope <= overshoot * slope) return length;
    for (int search = 0; search < max_searches; ++search) {  // regula falsi on the slope; a convex function has one zero of it
        const double fraction = std::clamp(-low_slope / (high_slope - low_slope), 0.1, 0.9);
        const double next = low + fraction * (high - low);
        add(network_, length - next, direction_, motion);
        length = next;
        forces(motion, false);
        const double left = -dot(network_, unbalanced_, direction_);
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

bool SinterStep::newton(double tolerance, bool balance, Motion& motion, StepReport& report) {
    const double balanced = std::clamp(imbalance_factor * tolerance, min_single, max_single);
    double sufficient = square(linear_fraction * tolerance);  // square of the error that linear solves may leave, over the work
    double closeness = 1.0, foretold = HUGE_VAL, imbalance_before = HUGE_VAL;
    std::vector<std::size_t> alone;  // out of balance: only these and their neighbours move
    // No more digits than the next iteration keeps, whose error is about the square of this one's, or than are required.
    const auto done = [&](const linalg::CgProgress& progress) {
        throw_if_stopped(settings_.stop);
        const double size = work_ > 0.0 ? std::sqrt(progress.energy / work_) : 1.0;
        const double goal = std::clamp(closeness * size, min_linear, max_linear);
        return progress.error2 <= std::max(square(goal) * progress.energy, sufficient * work_) ||
               progress.iterations >= max_conjugate_gradients;
    };
    forces(motion, true);
    for (int iteration = 0; iteration < max_newton; ++iteration) {
        linalg::CgProgress linear;
        if (alone.empty())
            linear = std::visit([&](auto& solver) {
                solver->factorise(branch_);
                return solver->solve(settings_.allowed_strain, unbalanced_, direction_, done);
            }, solver_);
        else
            relax(alone);
        ++report.newton;
        report.conjugate_gradients += linear.iterations;
        const double slope = dot(network_, unbalanced_, direction_);  // derivative along the direction, against which the step goes
        if (!std::isfinite(slope)) throw Error("a step of sintering meets a motion that is not a finite number");
        double error = 0.0, now = 0.0;
        if (slope > 0.0) {
            add(network_, -1.0, direction_, motion);
            forces(motion, false);
            const double length = line_search(slope, motion);
            error = std::sqrt(slope / std::max(work_, slope));  // of the motion before this iteration, energy norm
            now = length < 1.0 ? error : (linear.relative_error() + error) * error;
            if (alone.empty()) {
                if (error > surprise * foretold) closeness *= closer;
                foretold = now;
            }
            if (length < 0.5 && error < rounding) now = 0.0;
        }
        const bool moved_all = std::exchange(alone, {}).empty();
        if (now >= tolerance) continue;
        if (!balance) return true;
        report.imbalance = imbalance();
        if (report.imbalance <= balanced) return true;
        if (report.imbalance < min_progress * std::exchange(imbalance_before, report.imbalance)) alone = few_unbalanced(balanced);
        if (!alone.empty()) continue;
        imbalance_before = HUGE_VAL;
        if (sufficient == 0.0) return false;  // nothing that is left moves anything
        sufficient = slope > 0.0 || !moved_all ? square(sharpening) * sufficient : 0.0;
    }
    return false;
}

bool SinterStep::minimise(double tolerance, bool balance, Motion& motion, StepReport& report) {
    bool converged = newton(tolerance, balance, motion, report);
    for (int pass = 0; converged && limits_.any(); ++pass) {
        const double missed = limits_.update(
            [&](std::size_t row) { return approach(row, motion); },
            [&](std::size_t row) {
                const bool may_yield = step_[row].spring > 0.0 && pass >= settings_.limit_corrections;
                return may_yield ? HUGE_VAL : limit_accuracy * step_[row].reduced_radius;
            });
        if (missed <= 1.0) break;
        if (pass == max_limit_passes) return false;
        converged = newton(tolerance, balance, motion, report);
    }
    return converged;
}

void SinterStep::remove_drift(Motion& motion) const {
    Clusters clusters(network_.particles());
    const auto join = [&](std::size_t entry) {
        const bool held = limits_.any() && limits_.holds(static_cast<std::size_t>(network_.pair[entry]));
        if (entries_[entry].driving > 0.0 || entries_[entry].overlap > 0.0 || held)
            clusters.join(network_.first[entry], network_.second[entry]);
    };
    network_.for_chunks([&](std::size_t index) {  // within a chunk, no row of which leads out of it
        const ContactNetwork::Chunk& chunk = network_.chunks()[index];
        for (std::size_t entry = chunk.begin; entry < chunk.first_only; ++entry) join(entry);
    });
    for (const ContactNetwork::Chunk& chunk : network_.chunks()) {
        for (std::size_t entry = chunk.first_only; entry < chunk.second_only; ++entry) join(entry);
        for (std::size_t entry = chunk.crossing; entry < chunk.end; ++entry) join(entry);
    }
    struct Share {
        std::size_t root;
        Vec3 drift;
        double members;
    };
    // Of each chunk: its first particle's cluster, then the others as they come.
    std::vector<std::vector<Share>> shares(network_.chunks().size());
    std::vector<std::int32_t> roots(network_.particles());
    network_.for_chunks([&](std::size_t index) {
        const ContactNetwork::Chunk& chunk = network_.chunks()[index];
        std::vector<Share>& own = shares[index];
        for (std::size_t row = chunk.first_particle; row < chunk.last_particle; ++row) {
            roots[row] = clusters.root_of(static_cast<std::int32_t>(row));
            const auto root = static_cast<std::size_t>(roots[row]);
            const bool first = !own.empty() && own.front().root == root;
            if (!first && (own.empty() || own.back().root != root)) own.push_back({root, Vec3::Zero(), 0.0});
            Share& share = first ? own.front() : own.back();
            share.drift += Eigen::Map<const Vec3>(&motion.displacement[3 * row]);
            share.members += 1.0;
        }
    });
    std::vector<Vec3> drift(network_.particles(), Vec3::Zero());
    std::vector<double> members(network_.particles(), 0.0);
    for (const std::vector<Share>& own : shares)
        for (const Share& share : own) {
            drift[share.root] += share.drift;
            members[share.root] += share.members;
        }
    network_.for_chunks([&](std::size_t index) {
        const ContactNetwork::Chunk& chunk = network_.chunks()[index];
        for (std::size_t row = chunk.first_particle; row < chunk.last_particle; ++row) {
            const auto root = static_cast<std::size_t>(roots[row]);
            Eigen::Map<Vec3>(&motion.displacement[3 * row]) -= drift[root] / members[root];
        }
    });
}

StepReport SinterStep::first_order(Motion& motion) {
    StepReport report;
    start_geometry();
    report.converged = minimise(settings_.first_tolerance, settings_.balance_first, motion, report);
    remove_drift(motion);
    report.stress = strain_force_ / box_.volume();
    return report;
}

StepReport SinterStep::second_order(const Motion& first, Motion& motion) {
    StepReport report;
    const Vec3 stretch = Vec3::Ones() + 0.5 * first.strain;
    midpoint_geometry(first);
    report.converged = minimise(settings_.second_tolerance, true, motion, report);
    remove_drift(motion);
    report.stress = strain_force_.cwiseProduct(stretch) / (box_.volume() * stretch.prod());
    return report;
}

}  // namespace kiln::sintering
