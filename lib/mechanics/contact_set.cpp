// contact_set.cpp: overlaps, slides and forces of contacts by the freedoms of a reduced space.
#include "mechanics/contact_set.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "physics/hertz.h"

namespace kiln::mechanics {

namespace {

template <class Index>
std::size_t at(Index index) {
    return static_cast<std::size_t>(index);
}

/// Of the punch's surface against that of a contact, if the punch goes down by 1 m.
Vec3 slide_of_punch(const Vec3& push) { return Vec3::UnitZ() - push[2] * push; }

}  // namespace

ContactSet::ContactSet(const BondNetwork& network, const std::vector<WallContact>& walls, std::vector<PairContact> pairs,
                       double friction)
    : rotation_length_(network.rotation_length),
      walls_(walls.size()),
      open_pairs_(std::move(pairs)),
      tangential_(friction),
      approach_(0, 1),
      sliding_(0, 1),
      kept_(Eigen::VectorXd::Zero(1)) {
    for (const WallContact& wall : walls) {
        const double upwards = wall.normal[2];
        const Vec3 push = tangential_.active() ? wall.normal : Vec3(0.0, 0.0, upwards);
        const Vec3 arm = -wall.radius / rotation_length_ * wall.normal;
        add_contact({wall.node, -1, wall.punch, push, wall.gap * std::abs(upwards), wall.radius, wall.modulus, wall.shear_modulus,
                     arm, Vec3::Zero()});
        if (friction > 0.0) tangential_.add(wall.radius, wall.modulus, wall.shear_modulus, -contacts_.back().gap, Vec3::Zero());
    }
}

double ContactSet::approach(const Contact& contact, const Moved& moved) const {
    return -contact.push.dot(Vec3(moved.node.head<3>() - moved.other.head<3>()));
}

/// Of the node's surface against the other one, m.
Vec3 ContactSet::slide(const Contact& contact, const Moved& moved) const {
    const auto surface = [](const Vec6& node, const Vec3& arm) -> Vec3 {
        return node.head<3>() + Vec3(node.tail<3>()).cross(arm);
    };
    const Vec3 apart = surface(moved.node, contact.arm) - surface(moved.other, contact.other_arm);
    return apart - contact.push.dot(apart) * contact.push;
}

/// What a field does to a contact.
void ContactSet::add_rows(std::size_t contact, const ReducedSpace& space, std::size_t field) {
    const Contact& c = contacts_[contact];
    const auto row = static_cast<Eigen::Index>(contact), column = static_cast<Eigen::Index>(field) + 1;
    const Moved moved{space.displacement(field, at(c.node)),
                      c.other >= 0 ? space.displacement(field, at(c.other)) : Vec6(Vec6::Zero())};
    approach_(row, column) = approach(c, moved);
    if (tangential_.active()) sliding_.block<3, 1>(3 * row, column) = slide(c, moved);
}

/// A contact with its rows, of which that of the punch is filled.
void ContactSet::add_contact(const Contact& contact) {
    const Eigen::Index row = approach_.rows();
    contacts_.push_back(contact);
    approach_.conservativeResize(row + 1, Eigen::NoChange);
    approach_(row, 0) = contact.punch ? -contact.push[2] : 0.0;
    if (!tangential_.active()) return;
    sliding_.conservativeResize(3 * (row + 1), Eigen::NoChange);
    sliding_.block<3, 1>(3 * row, 0) = contact.punch ? slide_of_punch(contact.push) : Vec3::Zero();
}

bool ContactSet::add_closed_pairs(const ReducedSpace& space, const Vector& displacement) {
    return std::erase_if(open_pairs_, [&](const PairContact& pair) {
               const Vec3 push = -pair.vector.normalized(), arm = -push / rotation_length_;
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
               if (approach(contact, {displacement[at(pair.i)], displacement[at(pair.j)]}) <= pair.gap) return false;
               add_contact(contact);
               const std::size_t added = contacts_.size() - 1;
               for (std::size_t k = 0; k < space.fields(); ++k) add_rows(added, space, k);
               if (tangential_.active()) {
                   const auto row = static_cast<Eigen::Index>(added);
                   tangential_.add(pair.radius, pair.modulus, pair.shear_modulus, approach_.row(row).dot(kept_) - contact.gap,
                                   sliding_.middleRows<3>(3 * row) * kept_);
               }
               return true;
           }) > 0;
}

void ContactSet::add_field(const ReducedSpace& space, std::size_t field) {
    const Eigen::Index column = approach_.cols();
    approach_.conservativeResize(Eigen::NoChange, column + 1);
    sliding_.conservativeResize(Eigen::NoChange, column + 1);
    for (std::size_t c = 0; c < contacts_.size(); ++c) add_rows(c, space, field);
    kept_.conservativeResize(column + 1);
    kept_[column] = 0.0;
}

void ContactSet::remove_fields(std::size_t first, std::size_t last) {
    const std::vector<Eigen::Index> others = freedoms_without(at(approach_.cols()) - 1, first, last);
    approach_ = approach_(Eigen::all, others).eval();
    sliding_ = sliding_(Eigen::all, others).eval();
    kept_ = kept_(others).eval();
}

Eigen::VectorXd ContactSet::overlaps(const Eigen::VectorXd& freedoms) const {
    Eigen::VectorXd overlap = approach_ * freedoms;
    for (std::size_t c = 0; c < contacts_.size(); ++c) overlap[static_cast<Eigen::Index>(c)] -= contacts_[c].gap;
    return overlap;
}

ContactSet::Forces ContactSet::forces(const Eigen::VectorXd& freedoms) const {
    Forces result{Eigen::VectorXd::Zero(approach_.rows()), Eigen::VectorXd::Zero(approach_.rows()),
                  Eigen::VectorXd::Zero(sliding_.rows())};
    const Eigen::VectorXd closed = approach_ * freedoms, slides = sliding_ * freedoms;
    for (Eigen::Index c = 0; c < approach_.rows(); ++c) {
        const Contact& contact = contacts_[at(c)];
        const auto hertz = physics::hertz_contact(contact.modulus, contact.radius, closed[c] - contact.gap);
        result.force[c] = hertz.force;
        result.stiffness[c] = hertz.stiffness;
        result.energy += hertz.energy;
    }
    result.potential = result.energy;
    for (Eigen::Index c = 0; 3 * c < sliding_.rows(); ++c) {
        const auto friction = tangential_.potential(at(c), slides.segment<3>(3 * c));
        result.friction.segment<3>(3 * c) = friction.force;
        result.potential += friction.energy;
    }
    return result;
}

Eigen::VectorXd ContactSet::resistance(const Forces& forces) const {
    return approach_.transpose() * forces.force + sliding_.transpose() * forces.friction;
}

/// Contact by contact; not one matrix product, whose order of summation would depend on the number of threads.
void ContactSet::add_stiffness(const Forces& forces, const Eigen::VectorXd& freedoms, Eigen::MatrixXd& matrix) const {
    for (Eigen::Index c = 0; c < approach_.rows(); ++c) {
        if (forces.stiffness[c] <= 0.0) continue;
        const Eigen::VectorXd row = approach_.row(c);
        matrix.noalias() += forces.stiffness[c] * row * row.transpose();
    }
    for (Eigen::Index c = 0; 3 * c < sliding_.rows(); ++c) {
        const Eigen::Matrix<double, 3, Eigen::Dynamic> rows = sliding_.middleRows<3>(3 * c);
        const Eigen::Matrix3d gradient = tangential_.potential(at(c), rows * freedoms).gradient;
        if (gradient.isZero(0.0)) continue;
        const Eigen::Matrix<double, 3, Eigen::Dynamic> pull = gradient * rows;
        matrix += rows.transpose().lazyProduct(pull);
    }
}

Vec3 ContactSet::on_node(const Forces& forces, std::size_t contact) const {
    const auto row = static_cast<Eigen::Index>(contact);
    const Vec3 pressed = forces.force[row] * contacts_[contact].push;
    return tangential_.active() ? Vec3(pressed - forces.friction.segment<3>(3 * row)) : pressed;
}

void ContactSet::add_to_nodes(const Forces& forces, Vector& nodes) const {
    for (std::size_t c = 0; c < contacts_.size(); ++c) {
        const Contact& contact = contacts_[c];
        const Vec3 force = on_node(forces, c);
        nodes[at(contact.node)].head<3>() += force;
        if (contact.other >= 0) nodes[at(contact.other)].head<3>() -= force;
        if (!tangential_.active()) continue;
        nodes[at(contact.node)].tail<3>() += contact.arm.cross(force);
        if (contact.other >= 0) nodes[at(contact.other)].tail<3>() -= contact.other_arm.cross(force);
    }
}

std::vector<Vec3> ContactSet::on_walls(const Forces& forces) const {
    std::vector<Vec3> on_particle;
    for (std::size_t c = 0; c < walls_; ++c) on_particle.push_back(on_node(forces, c));
    return on_particle;
}

double ContactSet::punch_force(const Forces& forces) const {
    double sum = 0.0;
    for (std::size_t c = 0; c < walls_; ++c) {
        if (contacts_[c].punch) sum -= on_node(forces, c)[2];
    }
    return sum;
}

std::size_t ContactSet::closed_pairs(const Forces& forces) const {
    return at(std::count_if(forces.force.begin() + static_cast<std::ptrdiff_t>(walls_), forces.force.end(),
                            [](double force) { return force > 0.0; }));
}

double ContactSet::max_overlap(double force) const {
    double overlap = 0.0;
    for (const Contact& contact : contacts_) {
        overlap = std::max(overlap, physics::hertz_overlap(contact.modulus, contact.radius, force));
    }
    return overlap;
}

double ContactSet::max_approach(const Vector& displacement) const {
    double largest = 0.0;
    for (const Contact& contact : contacts_) {
        const Vec6 other = contact.other >= 0 ? displacement[at(contact.other)] : Vec6(Vec6::Zero());
        largest = std::max(largest, std::abs(approach(contact, {displacement[at(contact.node)], other})));
    }
    return largest;
}

void ContactSet::keep(const Eigen::VectorXd& freedoms) {
    tangential_.keep(overlaps(freedoms), sliding_ * freedoms);
    kept_ = freedoms;
}

void ContactSet::release(const Eigen::VectorXd& freedoms) {
    tangential_.release(overlaps(freedoms), sliding_ * freedoms);
    kept_ = freedoms;
}

}  // namespace kiln::mechanics
