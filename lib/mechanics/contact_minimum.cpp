// contact_minimum.cpp: damped Newton steps to the minimum of a convex energy.
#include "mechanics/contact_minimum.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace kiln::mechanics {

namespace {

constexpr int max_steps = 500;
constexpr double tolerance = 1e-13;  // unbalanced force in the space over the punch force

/// Takes the punch out of the unknowns.
void hold_punch(Eigen::VectorXd& gradient, Eigen::MatrixXd& matrix) {
    gradient[0] = 0.0;
    const double own = matrix(0, 0) > 0.0 ? matrix(0, 0) : 1.0;
    matrix.row(0).setZero();
    matrix.col(0).setZero();
    matrix(0, 0) = own;
}

}  // namespace

Eigen::MatrixXd tangent_stiffness(const ReducedSpace& space, const ContactSet& contacts, const ContactSet::Forces& forces,
                                  const Eigen::VectorXd& freedoms) {
    Eigen::MatrixXd matrix = space.stiffness();
    contacts.add_stiffness(forces, freedoms, matrix);
    return matrix;
}

/// Steps are damped (Levenberg & Marquardt) where the energy is flat or a full step does not lower it.
void minimise(const ReducedSpace& space, const ContactSet& contacts, const PunchLoad& load, Eigen::VectorXd& freedoms) {
    double damping = 1e-3;
    const double pushed = load.held ? 0.0 : load.force;
    const auto energy = [&](const ContactSet::Forces& forces, const Eigen::VectorXd& place) {
        return forces.potential + space.energy(place) - pushed * place[0];
    };
    ContactSet::Forces forces = contacts.forces(freedoms);
    double now = energy(forces, freedoms);
    for (int step = 0; step < max_steps; ++step) {
        Eigen::VectorXd gradient = contacts.resistance(forces);
        gradient.noalias() += space.stiffness() * freedoms;
        gradient[0] -= pushed;
        Eigen::MatrixXd matrix = tangent_stiffness(space, contacts, forces, freedoms);
        if (load.held) hold_punch(gradient, matrix);
        if (gradient.lpNorm<Eigen::Infinity>() <= tolerance * load.force) return;
        const double scale = matrix.trace() / static_cast<double>(matrix.rows());
        matrix.diagonal().array() += damping * scale;
        const Eigen::VectorXd move = -matrix.ldlt().solve(gradient);
        const Eigen::VectorXd moved = freedoms + move;
        const ContactSet::Forces there = contacts.forces(moved);
        const double then = energy(there, moved);
        // Near the minimum the energy no longer tells; rounding is let pass.
        if (then <= now + 1e-14 * load.force * std::abs(moved[0])) {
            freedoms = moved;
            forces = there;
            now = then;
            damping = damping > 1e-12 ? damping / 10.0 : 0.0;
        } else {
            damping = std::max(10.0 * damping, 1e-12);
        }
    }
}

}  // namespace kiln::mechanics
