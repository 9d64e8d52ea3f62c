// seating.cpp: rigid rotations of the bar, small ones after one another, until it rests on its cylinders.
#include "bending/seating.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace kiln::bending {

namespace {

constexpr double seating_force = 1e-9;  // of the estimated force at the greatest deflection
constexpr double max_turn = 0.05;   // rad, of one step: contacts that it meets on the way are not run over
constexpr double min_turn = 1e-7;  // rad, at which the bar is at rest; what it neglects goes with the square
constexpr int max_steps = 200;

/// Rotation vector of the rigid bar under the cylinders as they touch it now, as if it were small, rad.
Vec3 turn_under_cylinders(const Specimen& specimen, const Fixture& fixture, double force) {
    const mechanics::Tooling tooling = find_contacts(specimen, fixture);
    const mechanics::BondNetwork& network = specimen.body.network;
    return mechanics::seat_rigid(network, tooling.contacts, force).displacement.front().tail<3>() / network.rotation_length;
}

void turn_bar(Specimen& specimen, const Vec3& turn) {
    mechanics::BondNetwork& network = specimen.body.network;
    const Vec3 middle = specimen.origin + specimen.size / 2.0;
    const Eigen::Matrix3d rotation = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
    for (Vec3& position : specimen.state.particles.position) position = middle + rotation * (position - middle);
    for (Vec3& vector : network.vector) vector = rotation * vector;
    for (std::size_t node = 0; node < network.nodes(); ++node) {
        const Vec3 before = network.position[node];
        network.position[node] = specimen.state.particles.position[static_cast<std::size_t>(specimen.body.particle[node])];
        specimen.moved[node] += network.position[node] - before;
    }
    specimen.turn += turn;
}

}  // namespace

void seat_bar(Specimen& specimen, const Fixture& fixture, const Options& options) {
    const double force = seating_force * expected_force(specimen, fixture, options);
    specimen.moved.assign(specimen.body.network.nodes(), Vec3::Zero());
    double longest = max_turn;
    Vec3 last = Vec3::Zero();
    for (int step = 0; step < max_steps; ++step) {
        Vec3 turn = turn_under_cylinders(specimen, fixture, force);
        if (turn.norm() <= min_turn) return;
        if (turn.dot(last) < 0.0) longest *= 0.5;  // to and fro: between two contacts that small rotations cannot tell apart
        if (turn.norm() > longest) turn *= longest / turn.norm();
        turn_bar(specimen, turn);
        last = turn;
    }
    throw Error("the bar finds no rest between its cylinders: it turns to and fro on its particles");
}

}  // namespace kiln::bending
