// wall_contact.cpp: minimisation of the energy of a body in contact over a growing space of displacement fields.
#include "mechanics/wall_contact.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "physics/hertz.h"

namespace kiln::mechanics {

namespace {

constexpr double response_tolerance = 0.02;  // of one linear solve; the next one takes up what it leaves
constexpr int most_fields = 120;
constexpr int most_newton_steps = 500;
constexpr double newton_tolerance = 1e-13;  // unbalanced force in the space over the punch force
constexpr double second_pass = 0.1;         // share of a field's energy below which rounding calls for another orthogonalisation
constexpr double least_novelty = 1e-10;     // energy of a field that is not in the space already

std::size_t at(Eigen::Index index) { return static_cast<std::size_t>(index); }

}  // namespace

ContactProblem::ContactProblem(const BondNetwork& network, ElasticSolver* solver, std::vector<WallContact> contacts)
    : network_(network), solver_(solver), contacts_(std::move(contacts)) {
    amplitude_ = Eigen::VectorXd::Zero(1);
    closing_.resize(static_cast<Eigen::Index>(contacts_.size()), 1);
    for (std::size_t c = 0; c < contacts_.size(); ++c) closing_(static_cast<Eigen::Index>(c), 0) = contacts_[c].punch ? 1.0 : 0.0;
    Vec3 low = network.position.front(), high = low;
    for (const Vec3& position : network.position) {
        low = low.cwiseMin(position);
        high = high.cwiseMax(position);
    }
    const Vec3 middle = (low + high) / 2.0;
    const double size = (high - low).norm();
    // Lift, roll and pitch; the other rigid motions meet no contact.
    for (int motion = 0; motion < 3; ++motion) {
        Field field{Vector(network.nodes()), {}, 0.0};
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

void ContactProblem::add_field(Field field) {
    const Eigen::Index column = closing_.cols();
    closing_.conservativeResize(Eigen::NoChange, column + 1);
    for (std::size_t c = 0; c < contacts_.size(); ++c) {
        const double lift = field.displacement[at(contacts_[c].node)][2];
        closing_(static_cast<Eigen::Index>(c), column) = contacts_[c].punch ? lift : -lift;
    }
    amplitude_.conservativeResize(column + 1);
    amplitude_[column] = 0.0;
    fields_.push_back(std::move(field));
}

ContactProblem::Contacts ContactProblem::contacts_at(const Eigen::VectorXd& amplitude) const {
    Contacts result{Eigen::VectorXd::Zero(closing_.rows()), Eigen::VectorXd::Zero(closing_.rows()), 0.0};
    const Eigen::VectorXd closed = closing_ * amplitude;
    for (Eigen::Index c = 0; c < closing_.rows(); ++c) {
        const WallContact& contact = contacts_[at(c)];
        const auto hertz = physics::hertz_contact(contact.modulus, contact.radius, (closed[c] - contact.gap) * contact.cosine);
        result.force[c] = hertz.force * contact.cosine;
        result.stiffness[c] = hertz.stiffness * contact.cosine * contact.cosine;
        result.energy += hertz.energy;
    }
    return result;
}

double ContactProblem::energy(const Contacts& contacts, const Eigen::VectorXd& amplitude, double force) const {
    double sum = contacts.energy - force * amplitude[0];
    for (std::size_t k = 0; k < fields_.size(); ++k) {
        const double a = amplitude[static_cast<Eigen::Index>(k) + 1];
        sum += 0.5 * fields_[k].stiffness * a * a;
    }
    return sum;
}

/// Sum over the contacts that carry force; not a matrix product, whose order of summation would depend on the number of threads.
Eigen::MatrixXd ContactProblem::curvature(const Contacts& contacts) const {
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(closing_.cols(), closing_.cols());
    for (Eigen::Index c = 0; c < closing_.rows(); ++c) {
        if (contacts.stiffness[c] <= 0.0) continue;
        const Eigen::VectorXd row = closing_.row(c);
        matrix.noalias() += contacts.stiffness[c] * row * row.transpose();
    }
    for (std::size_t k = 0; k < fields_.size(); ++k) {
        const auto row = static_cast<Eigen::Index>(k) + 1;
        matrix(row, row) += fields_[k].stiffness;
    }
    return matrix;
}

/// Moves the supports' and the punch's first contacts to the overlap that carries the force, so that no step starts without a
/// contact.
void ContactProblem::touch_all(double force) {
    if (amplitude_[0] != 0.0) return;
    double overlap = 0.0;
    for (const WallContact& contact : contacts_) {
        overlap = std::max(overlap, std::pow(0.75 * force / (contact.modulus * std::sqrt(contact.radius)), 2.0 / 3.0));
    }
    amplitude_[0] = 2.0 * overlap;
    amplitude_[1] = -overlap;
}

/// Newton steps, damped (Levenberg & Marquardt) where the energy is flat or a full step does not lower it.
void ContactProblem::minimise(double force) {
    double damping = 1e-3;
    Contacts contacts = contacts_at(amplitude_);
    double now = energy(contacts, amplitude_, force);
    for (int step = 0; step < most_newton_steps; ++step) {
        Eigen::VectorXd gradient = closing_.transpose() * contacts.force;
        gradient[0] -= force;
        for (std::size_t k = 0; k < fields_.size(); ++k) {
            const auto row = static_cast<Eigen::Index>(k) + 1;
            gradient[row] += fields_[k].stiffness * amplitude_[row];
        }
        if (gradient.lpNorm<Eigen::Infinity>() <= newton_tolerance * force) return;
        Eigen::MatrixXd matrix = curvature(contacts);
        const double scale = matrix.trace() / static_cast<double>(matrix.rows());
        matrix.diagonal().array() += damping * scale;
        const Eigen::VectorXd move = -matrix.ldlt().solve(gradient);
        const Eigen::VectorXd moved = amplitude_ + move;
        const Contacts there = contacts_at(moved);
        const double then = energy(there, moved, force);
        // Near the minimum the energy no longer tells; rounding is let pass.
        if (then <= now + 1e-14 * force * std::abs(moved[0])) {
            amplitude_ = moved;
            contacts = there;
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
    double rest = 0.0;  // energy that the fields there do not have
    for (int pass = 0; pass == 0 || (pass == 1 && rest < second_pass * all); ++pass) {
        rest = all;
        for (const Field& other : fields_) {
            const bool rigid = other.force.empty();
            const double share = rigid ? dot(field.displacement, other.displacement) / dot(other.displacement, other.displacement)
                                       : dot(field.displacement, other.force) / other.stiffness;
            add(-share, other.displacement, field.displacement);
            rest -= share * share * other.stiffness;
        }
    }
    double largest = 0.0;
    for (const WallContact& contact : contacts_) {
        largest = std::max(largest, std::abs(field.displacement[at(contact.node)][2]));
    }
    if (!(largest > 0.0)) return;
    for (Vec6& each : field.displacement) each /= largest;
    solver_->forces(field.displacement, field.force);
    field.stiffness = dot(field.displacement, field.force);
    if (field.stiffness * largest * largest > least_novelty * all) add_field(std::move(field));
}

double ContactProblem::seat(double force) {
    touch_all(force);
    minimise(force);
    return amplitude_[0];
}

Equilibrium ContactProblem::solve(double force, double tolerance) {
    Equilibrium state;
    touch_all(force);
    while (true) {
        minimise(force);
        const Contacts contacts = contacts_at(amplitude_);
        Vector unbalanced = combine(true);
        for (Vec6& each : unbalanced) each = -each;
        for (std::size_t c = 0; c < contacts_.size(); ++c) {
            const double f = contacts.force[static_cast<Eigen::Index>(c)];
            unbalanced[at(contacts_[c].node)][2] += contacts_[c].punch ? -f : f;
        }
        state.residual = norm(unbalanced) / contacts.force.norm();
        state.converged = state.residual <= tolerance;
        const std::size_t fields = fields_.size();
        if (!state.converged && fields < most_fields) add_response(unbalanced, state.iterations);
        if (fields_.size() > fields) continue;
        state.displacement = combine(false);
        state.punch = amplitude_[0];
        state.contact_force.assign(contacts.force.begin(), contacts.force.end());
        state.contact_energy = contacts.energy;
        state.bond_energy = energy({contacts.force, contacts.stiffness, 0.0}, amplitude_, 0.0);
        state.punch_compliance = curvature(contacts).ldlt().solve(Eigen::VectorXd::Unit(amplitude_.size(), 0))[0];
        return state;
    }
}

}  // namespace kiln::mechanics
