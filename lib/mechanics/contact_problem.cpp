// contact_problem.cpp: minimisation of the energy of a body in contact over a growing space of displacement fields.
#include "mechanics/contact_problem.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "physics/hertz.h"

namespace kiln::mechanics {

namespace {

constexpr double response_tolerance = 0.1;  // of one linear solve; the next one takes up what it leaves
constexpr std::size_t most_fields = 120;
constexpr int most_newton_steps = 500;
constexpr double newton_tolerance = 1e-13;  // unbalanced force in the space over the punch force
constexpr double second_pass = 0.1;         // share of a field's energy below which rounding calls for another orthogonalisation
constexpr double least_novelty = 1e-10;     // energy of a field that is not in the space already

std::size_t at(Eigen::Index index) { return static_cast<std::size_t>(index); }

}  // namespace

ContactProblem::ContactProblem(const BondNetwork& network, ElasticSolver* solver, const std::vector<WallContact>& walls,
                               std::vector<PairContact> pairs)
    : network_(network), solver_(solver), walls_(walls.size()), open_pairs_(std::move(pairs)) {
    amplitude_ = Eigen::VectorXd::Zero(1);
    stiffness_ = Eigen::MatrixXd::Zero(1, 1);
    closing_.resize(0, 1);
    for (const WallContact& wall : walls) {
        const Vec3 push(0.0, 0.0, wall.punch ? -1.0 : 1.0);
        add_contact({wall.node, -1, wall.punch, push, wall.gap, wall.cosine, wall.radius, wall.modulus});
    }
    Vec3 low = network.position.front(), high = low;
    for (const Vec3& position : network.position) {
        low = low.cwiseMin(position);
        high = high.cwiseMax(position);
    }
    const Vec3 middle = (low + high) / 2.0;
    const double size = (high - low).norm();
    for (std::size_t motion = 0; motion < rigid_motions; ++motion) {
        Field field{Vector(network.nodes()), {}};
        for (std::size_t node = 0; node < network.nodes(); ++node) {
            const Vec3 lever = (network.position[node] - middle) / size;
            const double turn = network.rotation_length / size;
            if (motion == 0) field.displacement[node] << 0.0, 0.0, 1.0, 0.0, 0.0, 0.0;
            if (motion == 1) field.displacement[node] << 0.0, -lever[2], lever[1], turn, 0.0, 0.0;
            if (motion == 2) field.displacement[node] << lever[2], 0.0, -lever[0], 0.0, turn, 0.0;
        }
        add_field(std::move(field));
    }
}

double ContactProblem::closing(const Contact& contact, const Vector& displacement) const {
    Vec3 moved = displacement[at(contact.node)].head<3>();
    if (contact.other >= 0) moved -= displacement[at(contact.other)].head<3>();
    return -contact.push.dot(moved);
}

/// How far a displacement closes or opens the contact that it moves most, m.
double ContactProblem::largest_closing(const Vector& displacement) const {
    double largest = 0.0;
    for (const Contact& contact : contacts_) largest = std::max(largest, std::abs(closing(contact, displacement)));
    return largest;
}

void ContactProblem::add_contact(const Contact& contact) {
    const Eigen::Index row = closing_.rows();
    closing_.conservativeResize(row + 1, Eigen::NoChange);
    closing_(row, 0) = contact.punch ? 1.0 : 0.0;
    for (std::size_t k = 0; k < fields_.size(); ++k) {
        closing_(row, static_cast<Eigen::Index>(k) + 1) = closing(contact, fields_[k].displacement);
    }
    contacts_.push_back(contact);
}

/// Moves pairs whose gap has closed to the contacts; false if there are none.
bool ContactProblem::add_closed_pairs(const Vector& displacement) {
    return std::erase_if(open_pairs_, [&](const PairContact& pair) {
               const Contact contact{pair.i, pair.j, false, -pair.vector.normalized(), pair.gap, 1.0, pair.radius, pair.modulus};
               if (closing(contact, displacement) <= pair.gap) return false;
               add_contact(contact);
               return true;
           }) > 0;
}

void ContactProblem::add_field(Field field) {
    const Eigen::Index column = closing_.cols();
    closing_.conservativeResize(Eigen::NoChange, column + 1);
    for (std::size_t c = 0; c < contacts_.size(); ++c) {
        closing_(static_cast<Eigen::Index>(c), column) = closing(contacts_[c], field.displacement);
    }
    amplitude_.conservativeResize(column + 1);
    amplitude_[column] = 0.0;
    stiffness_.conservativeResize(column + 1, column + 1);
    stiffness_.row(column).setZero();
    stiffness_.col(column).setZero();
    fields_.push_back(std::move(field));
    const Field& added = fields_.back();
    if (added.force.empty()) return;
    for (std::size_t k = 0; k < fields_.size(); ++k) {
        if (fields_[k].force.empty()) continue;
        const auto row = static_cast<Eigen::Index>(k) + 1;
        stiffness_(row, column) = stiffness_(column, row) = dot(fields_[k].displacement, added.force);
    }
}

ContactProblem::Forces ContactProblem::forces_at(const Eigen::VectorXd& amplitude) const {
    Forces result{Eigen::VectorXd::Zero(closing_.rows()), Eigen::VectorXd::Zero(closing_.rows()), 0.0};
    const Eigen::VectorXd closed = closing_ * amplitude;
    for (Eigen::Index c = 0; c < closing_.rows(); ++c) {
        const Contact& contact = contacts_[at(c)];
        const auto hertz = physics::hertz_contact(contact.modulus, contact.radius, (closed[c] - contact.gap) * contact.cosine);
        result.force[c] = hertz.force * contact.cosine;
        result.stiffness[c] = hertz.stiffness * contact.cosine * contact.cosine;
        result.energy += hertz.energy;
    }
    return result;
}

double ContactProblem::energy(const Forces& forces, const Eigen::VectorXd& amplitude, double force) const {
    const Eigen::VectorXd bonds = stiffness_ * amplitude;
    return forces.energy + 0.5 * amplitude.dot(bonds) - force * amplitude[0];
}

/// Sum over the contacts that carry force; not a matrix product, whose order of summation would depend on the number of threads.
Eigen::MatrixXd ContactProblem::curvature(const Forces& forces) const {
    Eigen::MatrixXd matrix = stiffness_;
    for (Eigen::Index c = 0; c < closing_.rows(); ++c) {
        if (forces.stiffness[c] <= 0.0) continue;
        const Eigen::VectorXd row = closing_.row(c);
        matrix.noalias() += forces.stiffness[c] * row * row.transpose();
    }
    return matrix;
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

/// Newton steps, damped (Levenberg & Marquardt) where the energy is flat or a full step does not lower it.
void ContactProblem::minimise(double force) {
    double damping = 1e-3;
    Forces forces = forces_at(amplitude_);
    double now = energy(forces, amplitude_, force);
    for (int step = 0; step < most_newton_steps; ++step) {
        Eigen::VectorXd gradient = closing_.transpose() * forces.force + stiffness_ * amplitude_;
        gradient[0] -= force;
        if (gradient.lpNorm<Eigen::Infinity>() <= newton_tolerance * force) return;
        Eigen::MatrixXd matrix = curvature(forces);
        const double scale = matrix.trace() / static_cast<double>(matrix.rows());
        matrix.diagonal().array() += damping * scale;
        const Eigen::VectorXd move = -matrix.ldlt().solve(gradient);
        const Eigen::VectorXd moved = amplitude_ + move;
        const Forces there = forces_at(moved);
        const double then = energy(there, moved, force);
        // Near the minimum the energy no longer tells; rounding is let pass.
        if (then <= now + 1e-14 * force * std::abs(moved[0])) {
            amplitude_ = moved;
            forces = there;
            now = then;
            damping = damping > 1e-12 ? damping / 10.0 : 0.0;
        } else {
            damping = std::max(10.0 * damping, 1e-12);
        }
    }
}

Vector ContactProblem::combine(bool forces) const {
    Vector sum(network_.nodes(), Vec6::Zero());
    for (std::size_t k = 0; k < fields_.size(); ++k) {
        const Vector& field = forces ? fields_[k].force : fields_[k].displacement;
        if (!field.empty()) add(amplitude_[static_cast<Eigen::Index>(k) + 1], field, sum);
    }
    return sum;
}

/// Adds the body's response to unbalanced forces to the space, orthogonal in energy to the fields there and free of rigid motion.
void ContactProblem::add_response(const Vector& unbalanced, int& iterations) {
    Field field;
    iterations += solver_->solve(unbalanced, field.displacement, response_tolerance).iterations;
    const double all = dot(field.displacement, unbalanced);
    const Eigen::LDLT<Eigen::MatrixXd> elastic(
        stiffness_.bottomRightCorner(amplitude_.size() - 1 - rigid_motions, amplitude_.size() - 1 - rigid_motions));
    double rest = 0.0;  // energy that the fields there do not have
    for (int pass = 0; pass == 0 || (pass == 1 && rest < second_pass * all); ++pass) {
        Eigen::VectorXd loads(elastic.rows());
        for (std::size_t k = 0; k < fields_.size(); ++k) {
            const Field& other = fields_[k];
            if (k < rigid_motions) {
                add(-dot(field.displacement, other.displacement) / dot(other.displacement, other.displacement), other.displacement,
                    field.displacement);
            } else {
                loads[static_cast<Eigen::Index>(k - rigid_motions)] = dot(field.displacement, other.force);
            }
        }
        const Eigen::VectorXd shares = elastic.rows() > 0 ? elastic.solve(loads) : loads;
        for (std::size_t k = rigid_motions; k < fields_.size(); ++k) {
            add(-shares[static_cast<Eigen::Index>(k - rigid_motions)], fields_[k].displacement, field.displacement);
        }
        rest = all - loads.dot(shares);
    }
    const double largest = largest_closing(field.displacement);
    if (!(largest > 0.0)) return;
    for (Vec6& each : field.displacement) each /= largest;
    solver_->forces(field.displacement, field.force);
    if (dot(field.displacement, field.force) * largest * largest > least_novelty * all) add_field(std::move(field));
}

double ContactProblem::seat(double force) {
    touch_all(force);
    minimise(force);
    return amplitude_[0];
}

/// What the contacts do to the nodes less what the bonds hold against it.
Vector ContactProblem::unbalanced(const Forces& forces) const {
    Vector rest = combine(true);
    for (Vec6& each : rest) each = -each;
    for (std::size_t c = 0; c < contacts_.size(); ++c) {
        const Vec3 push = forces.force[static_cast<Eigen::Index>(c)] * contacts_[c].push;
        rest[at(contacts_[c].node)].head<3>() += push;
        if (contacts_[c].other >= 0) rest[at(contacts_[c].other)].head<3>() -= push;
    }
    return rest;
}

void ContactProblem::conclude(Equilibrium& state, const Forces& forces) const {
    state.punch = amplitude_[0];
    state.contact_force.assign(forces.force.begin(), forces.force.begin() + static_cast<std::ptrdiff_t>(walls_));
    state.closed_gaps = static_cast<std::size_t>(std::count_if(forces.force.begin() + static_cast<std::ptrdiff_t>(walls_),
                                                               forces.force.end(), [](double f) { return f > 0.0; }));
    state.contact_energy = forces.energy;
    state.bond_energy = energy({forces.force, forces.stiffness, 0.0}, amplitude_, 0.0);
    state.punch_compliance = curvature(forces).ldlt().solve(Eigen::VectorXd::Unit(amplitude_.size(), 0))[0];
}

Equilibrium ContactProblem::solve(double force, double tolerance) {
    Equilibrium state;
    touch_all(force);
    while (true) {
        minimise(force);
        const Forces forces = forces_at(amplitude_);
        const Vector rest = unbalanced(forces);
        state.residual = norm(rest) / forces.force.norm();
        state.converged = state.residual <= tolerance;
        const std::size_t fields = fields_.size();
        if (!state.converged && fields < most_fields) add_response(rest, state.iterations);
        if (fields_.size() > fields) continue;
        state.displacement = combine(false);
        if (add_closed_pairs(state.displacement)) continue;
        conclude(state, forces);
        return state;
    }
}

}  // namespace kiln::mechanics
