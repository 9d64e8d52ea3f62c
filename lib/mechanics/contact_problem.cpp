// contact_problem.cpp: minimisation of the energy of a body in contact over a growing space of displacement fields.
#include "mechanics/contact_problem.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "physics/hertz.h"

namespace kiln::mechanics {

namespace {

constexpr std::size_t most_fields = 120;
constexpr int most_newton_steps = 500;
constexpr double newton_tolerance = 1e-13;  // unbalanced force in the space over the punch force
constexpr double rounding_residual = 1e-9;  // below which rounding may have the last word
constexpr double least_progress = 0.5;      // residual with a field over that without it, below that

std::size_t at(Eigen::Index index) { return static_cast<std::size_t>(index); }

/// Takes the punch out of the unknowns.
void hold_punch(Eigen::VectorXd& gradient, Eigen::MatrixXd& matrix) {
    gradient[0] = 0.0;
    const double own = matrix(0, 0) > 0.0 ? matrix(0, 0) : 1.0;
    matrix.row(0).setZero();
    matrix.col(0).setZero();
    matrix(0, 0) = own;
}

}  // namespace

Eigen::VectorXd ContactProblem::overlaps() const {
    Eigen::VectorXd overlap = closing_ * amplitude_;
    for (std::size_t c = 0; c < contacts_.size(); ++c) overlap[static_cast<Eigen::Index>(c)] -= contacts_[c].gap;
    return overlap;
}

ContactProblem::Forces ContactProblem::forces_at(const Eigen::VectorXd& amplitude) const {
    Forces result{Eigen::VectorXd::Zero(closing_.rows()), Eigen::VectorXd::Zero(closing_.rows()),
                  Eigen::VectorXd::Zero(sliding_.rows())};
    const Eigen::VectorXd closed = closing_ * amplitude, slide = sliding_ * amplitude;
    for (Eigen::Index c = 0; c < closing_.rows(); ++c) {
        const Contact& contact = contacts_[at(c)];
        const auto hertz = physics::hertz_contact(contact.modulus, contact.radius, closed[c] - contact.gap);
        result.force[c] = hertz.force;
        result.stiffness[c] = hertz.stiffness;
        result.energy += hertz.energy;
    }
    result.potential = result.energy;
    for (Eigen::Index c = 0; 3 * c < sliding_.rows(); ++c) {
        const auto friction = grips_.potential(at(c), slide.segment<3>(3 * c));
        result.friction.segment<3>(3 * c) = friction.force;
        result.potential += friction.energy;
    }
    return result;
}

/// Sum over the contacts that carry force; not one matrix product, whose order of summation would depend on the number of threads.
Eigen::MatrixXd ContactProblem::curvature(const Forces& forces, const Eigen::VectorXd& amplitude) const {
    Eigen::MatrixXd matrix = stiffness_;
    for (Eigen::Index c = 0; c < closing_.rows(); ++c) {
        if (forces.stiffness[c] <= 0.0) continue;
        const Eigen::VectorXd row = closing_.row(c);
        matrix.noalias() += forces.stiffness[c] * row * row.transpose();
    }
    for (Eigen::Index c = 0; 3 * c < sliding_.rows(); ++c) {
        const Eigen::Matrix<double, 3, Eigen::Dynamic> rows = sliding_.middleRows<3>(3 * c);
        const Eigen::Matrix3d gradient = grips_.potential(at(c), rows * amplitude).gradient;
        if (gradient.isZero(0.0)) continue;
        const Eigen::Matrix<double, 3, Eigen::Dynamic> pull = gradient * rows;
        matrix += rows.transpose().lazyProduct(pull);
    }
    return matrix;
}

/// Newton steps, damped (Levenberg & Marquardt) where the energy is flat or a full step does not lower it.
void ContactProblem::minimise(const Drive& drive) {
    double damping = 1e-3;
    const double pushed = drive.held ? 0.0 : drive.force;
    const auto energy = [&](const Forces& forces, const Eigen::VectorXd& amplitude) {
        return forces.potential + bond_energy(amplitude) - pushed * amplitude[0];
    };
    Forces forces = forces_at(amplitude_);
    double now = energy(forces, amplitude_);
    for (int step = 0; step < most_newton_steps; ++step) {
        Eigen::VectorXd gradient =
            closing_.transpose() * forces.force + sliding_.transpose() * forces.friction + stiffness_ * amplitude_;
        gradient[0] -= pushed;
        Eigen::MatrixXd matrix = curvature(forces, amplitude_);
        if (drive.held) hold_punch(gradient, matrix);
        if (gradient.lpNorm<Eigen::Infinity>() <= newton_tolerance * drive.force) return;
        const double scale = matrix.trace() / static_cast<double>(matrix.rows());
        matrix.diagonal().array() += damping * scale;
        const Eigen::VectorXd move = -matrix.ldlt().solve(gradient);
        const Eigen::VectorXd moved = amplitude_ + move;
        const Forces there = forces_at(moved);
        const double then = energy(there, moved);
        // Near the minimum the energy no longer tells; rounding is let pass.
        if (then <= now + 1e-14 * drive.force * std::abs(moved[0])) {
            amplitude_ = moved;
            forces = there;
            now = then;
            damping = damping > 1e-12 ? damping / 10.0 : 0.0;
        } else {
            damping = std::max(10.0 * damping, 1e-12);
        }
    }
}

/// Moves the supports' and the punch's first contacts to the overlap that carries the force, so that no step starts without a
/// contact.
void ContactProblem::touch_all(double force) {
    if (amplitude_[0] != 0.0) return;
    double overlap = 0.0;
    for (const Contact& contact : contacts_) {
        overlap = std::max(overlap, physics::hertz_overlap(contact.modulus, contact.radius, force));
    }
    amplitude_[0] = 2.0 * overlap;
    amplitude_[1] = -overlap;
}

double ContactProblem::seat(double force) {
    touch_all(force);
    minimise({force});
    seated_ = amplitude_;
    release();
    return amplitude_[0];
}

Vec3 ContactProblem::force_on_node(const Forces& forces, std::size_t contact) const {
    const auto row = static_cast<Eigen::Index>(contact);
    const Vec3 pressed = forces.force[row] * contacts_[contact].push;
    return grips_.active() ? Vec3(pressed - forces.friction.segment<3>(3 * row)) : pressed;
}

/// What the contacts do to the nodes less what the bonds hold against it.
Vector ContactProblem::unbalanced(const Forces& forces) const {
    Vector rest = combine(true);
    for (Vec6& each : rest) each = -each;
    for (std::size_t c = 0; c < contacts_.size(); ++c) {
        const Contact& contact = contacts_[c];
        const Vec3 force = force_on_node(forces, c);
        rest[at(contact.node)].head<3>() += force;
        if (contact.other >= 0) rest[at(contact.other)].head<3>() -= force;
        if (!grips_.active()) continue;
        rest[at(contact.node)].tail<3>() += contact.arm.cross(force);
        if (contact.other >= 0) rest[at(contact.other)].tail<3>() -= contact.other_arm.cross(force);
    }
    return rest;
}

void ContactProblem::conclude(Equilibrium& state, const Forces& forces, const Drive& drive) const {
    state.punch = amplitude_[0];
    for (std::size_t c = 0; c < walls_; ++c) {
        state.contact_force.push_back(force_on_node(forces, c));
        if (contacts_[c].punch && drive.held) state.punch_force -= state.contact_force.back()[2];
    }
    if (!drive.held) state.punch_force = drive.force;
    state.closed_gaps = static_cast<std::size_t>(std::count_if(forces.force.begin() + static_cast<std::ptrdiff_t>(walls_),
                                                               forces.force.end(), [](double f) { return f > 0.0; }));
    state.contact_energy = forces.energy + grips_.stored(slides());
    state.friction_loss = friction_loss();
    state.bond_energy = bond_energy(amplitude_);
    state.punch_compliance = curvature(forces, amplitude_).ldlt().solve(Eigen::VectorXd::Unit(amplitude_.size(), 0))[0];
}

Equilibrium ContactProblem::solve(double force, double tolerance) {
    touch_all(force);
    return search({force}, tolerance);
}

Equilibrium ContactProblem::relax(double force, double tolerance) { return search({force, true}, tolerance); }

/// Where rounding has the last word, a field no longer helps: it is taken out again, since it would spoil the space.
Equilibrium ContactProblem::search(const Drive& drive, double tolerance) {
    Equilibrium state;
    Eigen::VectorXd before;       // amplitudes before the last field was added; empty if none was
    double before_residual = 0.0;
    while (true) {
        const bool settled = settle(drive, tolerance);
        Forces forces = forces_at(amplitude_);
        Vector rest = unbalanced(forces);
        state.residual = linalg::norm(rest) / forces.force.norm();
        const bool stuck = before.size() > 0 && state.residual > tolerance && before_residual < rounding_residual &&
                           !(state.residual < least_progress * before_residual);
        if (stuck) {
            remove_last_field();
            amplitude_ = before;
            grips_.follow(overlaps());
            forces = forces_at(amplitude_);
            rest = unbalanced(forces);
            state.residual = linalg::norm(rest) / forces.force.norm();
        }
        state.converged = settled && state.residual <= tolerance;
        const std::size_t fields = fields_.size();
        before = amplitude_;
        before_residual = state.residual;
        if (!stuck && state.residual > tolerance && fields < most_fields) add_response(rest, state.iterations);
        if (fields_.size() > fields) continue;
        before.resize(0);
        state.displacement = combine(false);
        if (add_closed_pairs(state.displacement)) continue;
        conclude(state, forces, drive);
        return state;
    }
}

}  // namespace kiln::mechanics
