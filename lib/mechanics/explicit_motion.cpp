// explicit_motion.cpp: leapfrog steps of a bonded body.
#include "mechanics/explicit_motion.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "physics/hertz.h"

namespace kiln::mechanics {

namespace {

constexpr double step_share = 0.8;            // of the longest stable step
constexpr double rotary_inertia = 2.0 / 5.0;  // of a sphere, over m r^2

std::size_t at(std::int64_t index) { return static_cast<std::size_t>(index); }

std::vector<Vec6> inverse_masses(const BondNetwork& network, const std::vector<ElasticSphere>& spheres,
                                 const std::vector<double>& mass) {
    std::vector<Vec6> inverse(mass.size());
    for (std::size_t node = 0; node < mass.size(); ++node) {
        const double gyration = spheres[node].radius / network.rotation_length;
        inverse[node].head<3>().setConstant(1.0 / mass[node]);
        inverse[node].tail<3>().setConstant(1.0 / (rotary_inertia * mass[node] * gyration * gyration));
    }
    return inverse;
}

}  // namespace

ExplicitMotion::ExplicitMotion(const BondNetwork& network, std::vector<ElasticSphere> spheres, const std::vector<double>& mass,
                               const Tooling& tooling, const MotionModel& model)
    : network_(network),
      incidence_(find_incidence(network.nodes(), network.pair)),
      inverse_mass_(inverse_masses(network, spheres, mass)),
      model_(model),
      contacts_(network, std::move(spheres), tooling, model.friction),
      displacement_(network.nodes(), Vec6::Zero()),
      velocity_(displacement_),
      force_(displacement_),
      hold_(network.bonds()),
      bond_force_(network.bonds(), Vec3::Zero()),
      shear_moment_(network.bonds(), Vec3::Zero()),
      damped_(network.nodes(), 0.0) {
    choose_time_step(tooling.contacts, model.max_force);
}

void ExplicitMotion::choose_time_step(const std::vector<WallContact>& walls, double max_force) {
    const std::vector<Mat6> blocks = linalg::diagonal_blocks({network_.nodes(), springs_of(network_)});
    std::vector<double> contact(network_.nodes(), 0.0);  // N/m, of the stiffest contact that a node may have
    const auto note = [&](std::int32_t node, double modulus, double radius) {
        const double overlap = physics::hertz_overlap(modulus, radius, max_force);
        contact[at(node)] = std::max(contact[at(node)], physics::hertz_contact(modulus, radius, overlap).stiffness);
    };
    for (const WallContact& wall : walls) note(wall.node, wall.modulus, wall.radius);
    double largest = 0.0;
    for (std::size_t node = 0; node < blocks.size(); ++node) {
        const Vec6 root = inverse_mass_[node].cwiseSqrt();
        Mat6 block = blocks[node];
        block.diagonal().head<3>().array() += contact[node];
        const Mat6 scaled = root.asDiagonal() * block * root.asDiagonal();
        largest = std::max(largest, Eigen::SelfAdjointEigenSolver<Mat6>(scaled, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff());
    }
    time_step_ = step_share * 2.0 / std::sqrt(2.0 * largest);
}

void ExplicitMotion::place(const Vector& displacement, double travel) {
    displacement_ = displacement;
    travel_ = travel;
}

/// Velocities over the displacements of now, then displacements on. Damping takes a share of every component of the unbalanced
/// force where it drives the motion, and adds it where it brakes.
void ExplicitMotion::kick_and_drift() {
    const double dt = time_step_, damping = model_.damping;
    for_rows(velocity_.size(), [&](std::size_t node) {
        Vec6& v = velocity_[node];
        double lost = 0.0;
        for (int k = 0; k < 6; ++k) {
            const double f = force_[node][k], before = v[k];
            const double brake = before == 0.0 ? 0.0 : -std::copysign(damping * f, before);
            v[k] += dt * inverse_mass_[node][k] * (f + brake);
            lost -= brake * 0.5 * (before + v[k]) * dt;
        }
        damped_[node] += lost;
        displacement_[node] += dt * v;
    }, worth_threads);
}

void ExplicitMotion::move_bonds() {
    const double dt = time_step_, per_length = 1.0 / network_.rotation_length;
    for_rows(hold_.size(), [&](std::size_t bond) {
        const std::size_t i = at(network_.pair[bond][0]), j = at(network_.pair[bond][1]);
        const Vec3 shift = displacement_[j].head<3>() - displacement_[i].head<3>();
        const Vec3 step = dt * (velocity_[j].head<3>() - velocity_[i].head<3>());
        const Vec3 vector = network_.vector[bond] + shift;
        const physics::BondStiffness& k = network_.stiffness[bond];
        physics::BondHold& hold = hold_[bond];
        physics::advance_bond(hold, k, vector - 0.5 * step, step, dt * per_length * velocity_[i].tail<3>(),
                              dt * per_length * velocity_[j].tail<3>());
        const double tension = k.normal * physics::lengthening(network_.vector[bond], shift);
        bond_force_[bond] = tension / vector.norm() * vector + hold.shear;
        shear_moment_[bond] = 0.5 * vector.cross(hold.shear);
    }, worth_threads);
}

void ExplicitMotion::gather() {
    const double per_length = 1.0 / network_.rotation_length;
    for_rows(force_.size(), [&](std::size_t node) {
        Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
        for (const std::int32_t row : incidence_.of(node)) {
            const std::size_t bond = at(row);
            const double side = at(network_.pair[bond][0]) == node ? 1.0 : -1.0;
            force += side * bond_force_[bond];
            moment += shear_moment_[bond] + side * hold_[bond].moment;
        }
        force_[node] << force, per_length * moment;
    }, worth_threads);
}

void ExplicitMotion::step(double punch_velocity) {
    work_ += contacts_.punch_force() * 0.5 * (punch_velocity_ + punch_velocity) * time_step_;
    kick_and_drift();
    travel_ += punch_velocity * time_step_;
    punch_velocity_ = punch_velocity;
    move_bonds();
    gather();
    contacts_.add_forces(displacement_, velocity_, travel_, punch_velocity, time_step_, force_);
}

std::vector<BondLoad> ExplicitMotion::loads() const {
    std::vector<BondLoad> loads(hold_.size());
    for (std::size_t bond = 0; bond < loads.size(); ++bond) {
        const std::size_t i = at(network_.pair[bond][0]), j = at(network_.pair[bond][1]);
        const Vec3 shift = displacement_[j].head<3>() - displacement_[i].head<3>();
        loads[bond] = {bond_force_[bond], hold_[bond].moment,
                       network_.stiffness[bond].normal * physics::lengthening(network_.vector[bond], shift)};
    }
    return loads;
}

MotionEnergy ExplicitMotion::energy() const {
    MotionEnergy energy;
    energy.work = work_;
    energy.contacts = contacts_.energy();
    energy.friction = contacts_.friction_loss();
    for (const double each : damped_) energy.damping += each;
    for (std::size_t node = 0; node < velocity_.size(); ++node) {
        const Vec6 now = velocity_[node] + 0.5 * time_step_ * inverse_mass_[node].cwiseProduct(force_[node]);
        energy.kinetic += 0.5 * now.cwiseAbs2().cwiseQuotient(inverse_mass_[node]).sum();
    }
    const std::vector<BondLoad> loads = this->loads();
    for (std::size_t bond = 0; bond < loads.size(); ++bond) {
        const physics::BondStiffness& k = network_.stiffness[bond];
        const std::size_t i = at(network_.pair[bond][0]), j = at(network_.pair[bond][1]);
        const Vec3 along = (network_.vector[bond] + displacement_[j].head<3>() - displacement_[i].head<3>()).normalized();
        const double twist = hold_[bond].moment.dot(along);
        const double bending = hold_[bond].moment.squaredNorm() - twist * twist;
        energy.bonds += 0.5 * (loads[bond].tension * loads[bond].tension / k.normal + hold_[bond].shear.squaredNorm() / k.shear +
                               twist * twist / k.torsion + bending / k.bending);
    }
    return energy;
}

}  // namespace kiln::mechanics
