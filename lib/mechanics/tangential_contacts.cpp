// tangential_contacts.cpp: stiffness, limit and losses of the contacts' tangential springs.
#include "mechanics/tangential_contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "physics/hertz.h"

namespace kiln::mechanics {

namespace {

Vec3 row_of(const Eigen::VectorXd& rows, std::size_t contact) { return rows.segment<3>(3 * static_cast<Eigen::Index>(contact)); }

}  // namespace

Vec3 TangentialContacts::displacement(const Contact& contact, const Vec3& slide) {
    return contact.carried + contact.share * (slide - contact.slide);
}

Vec3 TangentialContacts::elastic(const Contact& contact, const Vec3& slide) {
    return physics::elastic_displacement(displacement(contact, slide), contact.stiffness, contact.limit);
}

void TangentialContacts::add(double radius, double modulus, double shear_modulus, double overlap, const Vec3& slide) {
    contacts_.push_back({radius, modulus, shear_modulus, overlap, slide, {}});
}

void TangentialContacts::stick(double force) {
    undecided_ = false;
    for (Contact& contact : contacts_) {
        const double overlap = physics::hertz_overlap(contact.modulus, contact.radius, force);
        contact.stiffness = physics::mindlin_stiffness(contact.shear_modulus, contact.radius, overlap);
        contact.limit = std::numeric_limits<double>::infinity();
    }
}

double TangentialContacts::follow(const Eigen::VectorXd& overlap) {
    double change = 0.0;
    for (std::size_t c = 0; c < contacts_.size(); ++c) {
        Contact& contact = contacts_[c];
        const double now = overlap[static_cast<Eigen::Index>(c)];
        const double limit = friction_ * physics::hertz_contact(contact.modulus, contact.radius, now).force;
        change = std::max(change, std::abs(limit - contact.limit));
        contact.limit = limit;
        contact.stiffness = physics::mindlin_stiffness(contact.shear_modulus, contact.radius, now);
        contact.share = now > 0.0 && contact.overlap < 0.0 ? now / (now - contact.overlap) : 1.0;
        contact.carried = physics::carried_displacement(contact.spring, contact.stiffness);
    }
    return change;
}

physics::FrictionPotential TangentialContacts::potential(std::size_t contact, const Vec3& slide) const {
    const Contact& here = contacts_[contact];
    physics::FrictionPotential result = physics::friction_potential(displacement(here, slide), here.stiffness, here.limit);
    result.energy /= here.share;
    result.gradient *= here.share;
    return result;
}

double TangentialContacts::stored(const Eigen::VectorXd& slide) const {
    double sum = 0.0;
    for (std::size_t c = 0; c < contacts_.size(); ++c) {
        sum += physics::TangentialSpring{contacts_[c].stiffness, elastic(contacts_[c], row_of(slide, c))}.energy();
    }
    return sum;
}

double TangentialContacts::lost(const Eigen::VectorXd& slide) const {
    double sum = lost_;
    for (std::size_t c = 0; c < contacts_.size(); ++c) {
        const Contact& contact = contacts_[c];
        const Vec3 required = displacement(contact, row_of(slide, c));
        const double slip = required.norm() - physics::elastic_displacement(required, contact.stiffness, contact.limit).norm();
        sum += contact.spring.energy() - physics::TangentialSpring{contact.stiffness, contact.carried}.energy();
        // The limit grew or fell on the way.
        sum += 0.5 * (contact.last_limit + contact.limit) * slip;
    }
    return sum;
}

void TangentialContacts::keep(const Eigen::VectorXd& overlap, const Eigen::VectorXd& slide) {
    lost_ = lost(slide);
    for (std::size_t c = 0; c < contacts_.size(); ++c) {
        Contact& contact = contacts_[c];
        contact.spring = {contact.stiffness, elastic(contact, row_of(slide, c))};
        contact.overlap = overlap[static_cast<Eigen::Index>(c)];
        contact.slide = row_of(slide, c);
        contact.last_limit = contact.limit;
        contact.share = 1.0;
        contact.carried = contact.spring.displacement;
    }
}

void TangentialContacts::release(const Eigen::VectorXd& overlap, const Eigen::VectorXd& slide) {
    undecided_ = true;
    for (std::size_t c = 0; c < contacts_.size(); ++c) {
        Contact& contact = contacts_[c];
        lost_ += contact.spring.energy();
        contact = {
            contact.radius, contact.modulus, contact.shear_modulus, overlap[static_cast<Eigen::Index>(c)], row_of(slide, c), {}};
    }
}

}  // namespace kiln::mechanics
