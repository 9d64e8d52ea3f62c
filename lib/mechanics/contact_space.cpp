// contact_space.cpp: the contacts of a body and the displacement fields among which its equilibria are sought.
#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "mechanics/contact_problem.h"

namespace kiln::mechanics {

namespace {

constexpr double response_tolerance = 0.1;  // of one linear solve; the next one takes up what it leaves
constexpr double second_pass = 0.1;         // share of a field's energy below which rounding calls for another orthogonalisation
constexpr double least_novelty = 1e-10;     // energy of a field that is not in the space already

std::size_t at(Eigen::Index index) { return static_cast<std::size_t>(index); }

}  // namespace

ContactProblem::ContactProblem(const BondNetwork& network, ElasticSolver* solver, const std::vector<WallContact>& walls,
                               std::vector<PairContact> pairs, double friction)
    : network_(network), solver_(solver), walls_(walls.size()), open_pairs_(std::move(pairs)), grips_(friction) {
    amplitude_ = kept_ = seated_ = Eigen::VectorXd::Zero(1);
    stiffness_ = Eigen::MatrixXd::Zero(1, 1);
    closing_.resize(0, 1);
    sliding_.resize(0, 1);
    for (const WallContact& wall : walls) {
        const double upwards = wall.normal[2];
        const Vec3 push = grips_.active() ? wall.normal : Vec3(0.0, 0.0, upwards);
        const Vec3 arm = -wall.radius / network.rotation_length * wall.normal;
        add_contact({wall.node, -1, wall.punch, push, wall.gap * std::abs(upwards), wall.radius, wall.modulus, wall.shear_modulus,
                     arm, Vec3::Zero()});
    }
    add_rigid_motion(Vec3::UnitZ(), Vec3::Zero());
    add_rigid_motion(Vec3::Zero(), Vec3::UnitX());
    add_rigid_motion(Vec3::Zero(), Vec3::UnitY());
}

/// A shift and a turn about the middle of the network, both of the size that the network has.
void ContactProblem::add_rigid_motion(const Vec3& shift, const Vec3& turn) {
    Vec3 low = network_.position.front(), high = low;
    for (const Vec3& position : network_.position) {
        low = low.cwiseMin(position);
        high = high.cwiseMax(position);
    }
    const Vec3 middle = (low + high) / 2.0;
    const double size = (high - low).norm();
    Field field{Vector(network_.nodes()), {}};
    for (std::size_t node = 0; node < network_.nodes(); ++node) {
        const Vec3 lever = (network_.position[node] - middle) / size;
        field.displacement[node] << shift + turn.cross(lever), network_.rotation_length / size * turn;
    }
    add_field(std::move(field));
    ++rigid_motions_;
}

double ContactProblem::closing(const Contact& contact, const Vector& displacement) const {
    Vec3 moved = displacement[at(contact.node)].head<3>();
    if (contact.other >= 0) moved -= displacement[at(contact.other)].head<3>();
    return -contact.push.dot(moved);
}

/// Of the node's surface against the other one, m.
Vec3 ContactProblem::sliding(const Contact& contact, const Vector& displacement) const {
    const auto surface = [&](std::int32_t node, const Vec3& arm) -> Vec3 {
        return displacement[at(node)].head<3>() + displacement[at(node)].tail<3>().cross(arm);
    };
    Vec3 moved = surface(contact.node, contact.arm);
    if (contact.other >= 0) moved -= surface(contact.other, contact.other_arm);
    return moved - contact.push.dot(moved) * contact.push;
}

/// The same for a punch that goes down by 1 m.
Vec3 ContactProblem::sliding_with_punch(const Contact& contact) const {
    if (!contact.punch) return Vec3::Zero();
    return Vec3::UnitZ() - contact.push[2] * contact.push;
}

/// How far a displacement closes or opens the contact that it moves most, m.
double ContactProblem::largest_closing(const Vector& displacement) const {
    double largest = 0.0;
    for (const Contact& contact : contacts_) largest = std::max(largest, std::abs(closing(contact, displacement)));
    return largest;
}

/// What a field does to a contact.
void ContactProblem::add_rows(std::size_t contact, Eigen::Index column, const Vector& displacement) {
    const auto row = static_cast<Eigen::Index>(contact);
    closing_(row, column) = closing(contacts_[contact], displacement);
    if (grips_.active()) sliding_.block<3, 1>(3 * row, column) = sliding(contacts_[contact], displacement);
}

void ContactProblem::add_contact(const Contact& contact) {
    const Eigen::Index row = closing_.rows();
    contacts_.push_back(contact);
    closing_.conservativeResize(row + 1, Eigen::NoChange);
    closing_(row, 0) = contact.punch ? -contact.push[2] : 0.0;
    if (grips_.active()) {
        sliding_.conservativeResize(3 * (row + 1), Eigen::NoChange);
        sliding_.block<3, 1>(3 * row, 0) = sliding_with_punch(contact);
    }
    for (std::size_t k = 0; k < fields_.size(); ++k) {
        add_rows(at(row), static_cast<Eigen::Index>(k) + 1, fields_[k].displacement);
    }
    if (!grips_.active()) return;
    grips_.add(contact.radius, contact.modulus, contact.shear_modulus, closing_.row(row).dot(kept_) - contact.gap,
               sliding_.middleRows<3>(3 * row) * kept_);
}

/// Moves pairs whose gap has closed to the contacts; false if there are none.
bool ContactProblem::add_closed_pairs(const Vector& displacement) {
    return std::erase_if(open_pairs_, [&](const PairContact& pair) {
               const Vec3 push = -pair.vector.normalized(), arm = -push / network_.rotation_length;
               const Contact contact{pair.i,
                                     pair.j,
                                     false,
                                     push,
                                     pair.gap,
                                     pair.radius,
                                     pair.modulus,
                                     pair.shear_modulus,
                                     pair.radius_i * arm,
                                     -pair.radius_j * arm};
               if (closing(contact, displacement) <= pair.gap) return false;
               add_contact(contact);
               return true;
           }) > 0;
}

void ContactProblem::add_field(Field field) {
    const Eigen::Index column = closing_.cols();
    closing_.conservativeResize(Eigen::NoChange, column + 1);
    sliding_.conservativeResize(Eigen::NoChange, column + 1);
    for (std::size_t c = 0; c < contacts_.size(); ++c) add_rows(c, column, field.displacement);
    for (Eigen::VectorXd* amplitude : {&amplitude_, &kept_}) {
        amplitude->conservativeResize(column + 1);
        (*amplitude)[column] = 0.0;
    }
    stiffness_.conservativeResize(column + 1, column + 1);
    stiffness_.row(column).setZero();
    stiffness_.col(column).setZero();
    fields_.push_back(std::move(field));
    const Field& added = fields_.back();
    if (added.force.empty()) return;
    for (std::size_t k = 0; k < fields_.size(); ++k) {
        if (fields_[k].force.empty()) continue;
        const auto row = static_cast<Eigen::Index>(k) + 1;
        stiffness_(row, column) = stiffness_(column, row) = linalg::dot(fields_[k].displacement, added.force);
    }
}

void ContactProblem::remove_last_field() {
    fields_.pop_back();
    const auto columns = static_cast<Eigen::Index>(fields_.size()) + 1;
    closing_.conservativeResize(Eigen::NoChange, columns);
    sliding_.conservativeResize(Eigen::NoChange, columns);
    amplitude_.conservativeResize(columns);
    kept_.conservativeResize(columns);
    stiffness_.conservativeResize(columns, columns);
}

Vector ContactProblem::combine(bool forces) const {
    Vector sum(network_.nodes(), Vec6::Zero());
    for (std::size_t k = 0; k < fields_.size(); ++k) {
        const Vector& field = forces ? fields_[k].force : fields_[k].displacement;
        if (!field.empty()) linalg::add(amplitude_[static_cast<Eigen::Index>(k) + 1], field, sum);
    }
    return sum;
}

/// Adds the body's response to unbalanced forces to the space, orthogonal in energy to the fields there and free of rigid motion.
void ContactProblem::add_response(const Vector& unbalanced, int& iterations) {
    Field field;
    iterations += solver_->solve(unbalanced, field.displacement, response_tolerance).iterations;
    const double all = linalg::dot(field.displacement, unbalanced);
    const auto elastic_fields = static_cast<Eigen::Index>(fields_.size() - rigid_motions_);
    const Eigen::LDLT<Eigen::MatrixXd> elastic(stiffness_.bottomRightCorner(elastic_fields, elastic_fields));
    double rest = 0.0;  // energy that the fields there do not have
    for (int pass = 0; pass == 0 || (pass == 1 && rest < second_pass * all); ++pass) {
        Eigen::VectorXd loads(elastic.rows());
        for (std::size_t k = 0; k < fields_.size(); ++k) {
            const Field& other = fields_[k];
            if (k < rigid_motions_) {
                linalg::add(
                    -linalg::dot(field.displacement, other.displacement) / linalg::dot(other.displacement, other.displacement),
                    other.displacement, field.displacement);
            } else {
                loads[static_cast<Eigen::Index>(k - rigid_motions_)] = linalg::dot(field.displacement, other.force);
            }
        }
        const Eigen::VectorXd shares = elastic.rows() > 0 ? elastic.solve(loads) : loads;
        for (std::size_t k = rigid_motions_; k < fields_.size(); ++k) {
            linalg::add(-shares[static_cast<Eigen::Index>(k - rigid_motions_)], fields_[k].displacement, field.displacement);
        }
        rest = all - loads.dot(shares);
    }
    const double largest = largest_closing(field.displacement);
    if (!(largest > 0.0)) return;
    for (Vec6& each : field.displacement) each /= largest;
    solver_->forces(field.displacement, field.force);
    if (linalg::dot(field.displacement, field.force) * largest * largest > least_novelty * all) add_field(std::move(field));
}

}  // namespace kiln::mechanics
