// explicit_contacts.cpp: forces of Hertz-Mindlin contacts, and when to look for new ones.
#include "mechanics/explicit_contacts.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/parallel.h"
#include "physics/bond_motion.h"
#include "physics/hertz.h"

namespace kiln::mechanics {

namespace {

constexpr double margin = 0.1;  // of the mean radius: pairs with a smaller gap are watched

std::size_t at(std::int32_t index) { return static_cast<std::size_t>(index); }

/// Velocity of a sphere's surface at `arm` from its centre; rotations are scaled by the rotation length.
Vec3 surface_velocity(const Vec6& velocity, const Vec3& arm, double rotation_length) {
    return velocity.head<3>() + velocity.tail<3>().cross(arm) / rotation_length;
}

}  // namespace

ExplicitContacts::ExplicitContacts(const BondNetwork& network, std::vector<ElasticSphere> spheres, Tooling tooling, double friction)
    : network_(network),
      spheres_(std::move(spheres)),
      tooling_(std::move(tooling)),
      friction_(friction),
      margin_(margin * network.rotation_length),
      wall_spring_(tooling_.contacts.size()),
      wall_force_(tooling_.contacts.size(), Vec3::Zero()) {
    search(Vector(network.nodes(), Vec6::Zero()));
}

/// Pairs near each other now; springs of pairs that were near before are kept.
void ExplicitContacts::search(const Vector& displacement) {
    std::vector<PairContact> found = near_pairs(network_, spheres_, displacement, margin_);
    std::vector<physics::TangentialSpring> spring(found.size());
    std::size_t old = 0;
    for (std::size_t k = 0; k < found.size(); ++k) {
        const std::array key{found[k].i, found[k].j};
        while (old < pairs_.size() && std::array{pairs_[old].i, pairs_[old].j} < key) ++old;
        if (old < pairs_.size() && std::array{pairs_[old].i, pairs_[old].j} == key) spring[k] = pair_spring_[old];
    }
    pairs_ = std::move(found);
    pair_spring_ = std::move(spring);
    overlap_.resize(pairs_.size());
    searched_at_ = displacement;
}

/// m. While no particle has gone farther than half the margin, no two that were not near each other have met.
double ExplicitContacts::farthest_since_search(const Vector& displacement) const {
    return std::sqrt(greatest_of_rows(displacement.size(), 0.0, [&](std::size_t node) {
        return (displacement[node] - searched_at_[node]).head<3>().squaredNorm();
    }));
}

/// Moves the tangential spring along by `slide`, m, the way of the other surface against the sphere's; force on the sphere, N.
Vec3 ExplicitContacts::friction_force(const Touch& touch, const Vec3& slide, physics::TangentialSpring& spring) {
    const double stiffness = physics::mindlin_stiffness(touch.shear_modulus, touch.radius, touch.overlap);
    const double limit = friction_ * physics::hertz_contact(touch.modulus, touch.radius, touch.overlap).force;
    const physics::TangentialSpring before = std::exchange(spring, {stiffness, physics::carried_displacement(spring, stiffness)});
    loss_ += before.energy() - spring.energy();
    spring.displacement += slide;
    spring.displacement -= spring.displacement.dot(touch.normal) * touch.normal;
    const double required = spring.displacement.norm();
    spring.displacement = physics::elastic_displacement(spring.displacement, stiffness, limit);
    loss_ += limit * (required - spring.displacement.norm());
    energy_ += spring.energy();
    return stiffness * spring.displacement;
}

void ExplicitContacts::add_pairs(const Vector& displacement, const Vector& velocity, double dt, Vector& force) {
    const double length = network_.rotation_length;
    for_rows(pairs_.size(), [&](std::size_t k) {
        const PairContact& pair = pairs_[k];
        const Vec3 shift = displacement[at(pair.j)].head<3>() - displacement[at(pair.i)].head<3>();
        overlap_[k] = -physics::lengthening(pair.vector, shift) - pair.gap;
    }, worth_threads);
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
        if (overlap_[k] <= 0.0) {
            loss_ += std::exchange(pair_spring_[k], {}).energy();
            continue;
        }
        const PairContact& pair = pairs_[k];
        const std::size_t i = at(pair.i), j = at(pair.j);
        const Vec3 normal = (pair.vector + displacement[j].head<3>() - displacement[i].head<3>()).normalized();
        const physics::HertzContact hertz = physics::hertz_contact(pair.modulus, pair.radius, overlap_[k]);
        const Vec3 arm_i = spheres_[i].radius * normal, arm_j = -spheres_[j].radius * normal;
        Vec3 on_i = -hertz.force * normal;
        energy_ += hertz.energy;
        ++touching_pairs_;
        if (friction_ > 0.0) {
            const Vec3 slide = dt * (surface_velocity(velocity[j], arm_j, length) - surface_velocity(velocity[i], arm_i, length));
            on_i += friction_force({normal, overlap_[k], pair.radius, pair.modulus, pair.shear_modulus}, slide, pair_spring_[k]);
        }
        force[i].head<3>() += on_i;
        force[j].head<3>() -= on_i;
        force[i].tail<3>() += arm_i.cross(on_i) / length;
        force[j].tail<3>() -= arm_j.cross(on_i) / length;
    }
}

void ExplicitContacts::add_walls(const Vector& displacement, const Vector& velocity, double travel, double punch_velocity,
                                 double dt, Vector& force) {
    const double length = network_.rotation_length;
    for (std::size_t c = 0; c < tooling_.contacts.size(); ++c) {
        const WallContact& contact = tooling_.contacts[c];
        const Cylinder& cylinder = tooling_.cylinders[at(contact.cylinder)];
        const std::size_t node = at(contact.node);
        Vec3 place = network_.position[node] + displacement[node].head<3>();
        if (friction_ == 0.0) place[0] = network_.position[node][0];  // a roller goes along with what it carries
        const Vec3 towards(cylinder.x - place[0], 0.0, cylinder.z - (cylinder.punch ? travel : 0.0) - place[2]);
        const double distance = towards.norm(), overlap = cylinder.radius + contact.radius - distance;
        wall_force_[c].setZero();
        if (overlap <= 0.0) {
            loss_ += std::exchange(wall_spring_[c], {}).energy();
            continue;
        }
        const Vec3 normal = towards / distance, arm = contact.radius * normal;
        const physics::HertzContact hertz = physics::hertz_contact(contact.modulus, contact.radius, overlap);
        Vec3 on_sphere = -hertz.force * normal;
        energy_ += hertz.energy;
        if (friction_ > 0.0) {
            const Vec3 wall_velocity(0.0, 0.0, cylinder.punch ? -punch_velocity : 0.0);
            const Vec3 slide = dt * (wall_velocity - surface_velocity(velocity[node], arm, length));
            const Touch touch{normal, overlap, contact.radius, contact.modulus, contact.shear_modulus};
            on_sphere += friction_force(touch, slide, wall_spring_[c]);
            force[node].tail<3>() += arm.cross(on_sphere) / length;
        } else {
            on_sphere[0] = 0.0;
        }
        force[node].head<3>() += on_sphere;
        wall_force_[c] = on_sphere;
        if (cylinder.punch) punch_force_ -= on_sphere[2];
    }
}

void ExplicitContacts::add_forces(const Vector& displacement, const Vector& velocity, double travel, double punch_velocity,
                                  double dt, Vector& force) {
    if (farthest_since_search(displacement) > margin_ / 2.0) search(displacement);
    punch_force_ = energy_ = 0.0;
    touching_pairs_ = 0;
    add_pairs(displacement, velocity, dt, force);
    add_walls(displacement, velocity, travel, punch_velocity, dt, force);
}

}  // namespace kiln::mechanics
