// contact_problem_test.cpp: the parts of the contact problem: fields and what holds them, contacts and their potential.
#include "mechanics/contact_problem.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "tests/physics/assembled.h"
#include "tests/physics/bonded_lattice.h"
#include "tests/physics/relative.h"

using namespace kiln;
using namespace kiln::mechanics;
using test::relative;

namespace {

BondedBody rough_body() {
    return bonded_body(
        test::make_lattice({.cells = {12, 3, 3}, .neighbour = 1.25, .periodic = false, .jitter = 0.2, .random_radii = true}), {});
}

/// Forces at all nodes that differ from one number to the next, N.
Vector uneven_load(const BondNetwork& network, int number) {
    Vector load(network.nodes(), Vec6::Zero());
    for (std::size_t node = 0; node < network.nodes(); ++node) {
        for (int k = 0; k < 3; ++k) load[node][k] = 1e-9 * std::sin(static_cast<double>(node) * (1.3 + number) + 2.0 * k);
    }
    // In balance, so that nothing holds the body.
    Vec3 sum = Vec3::Zero();
    for (const Vec6& each : load) sum += each.head<3>();
    for (Vec6& each : load) each.head<3>() -= sum / static_cast<double>(network.nodes());
    return load;
}

double max_displacement(const Vector& displacement) {
    double largest = 0.0;
    for (const Vec6& each : displacement) largest = std::max(largest, each.head<3>().cwiseAbs().maxCoeff());
    return largest;
}

/// J, by the matrix of the network.
double energy_in_bonds(const BondNetwork& network, const Vector& displacement) {
    Vector force;
    linalg::multiply(test::stiffness_matrix(network), displacement, force);
    return 0.5 * linalg::dot(displacement, force);
}

/// A space of three rigid motions and so many responses.
void fill(ReducedSpace& space, ElasticSolver& solver, const BondNetwork& network, int responses) {
    space.add_rigid_motion(Vec3::UnitZ(), Vec3::Zero());
    space.add_rigid_motion(Vec3::Zero(), Vec3::UnitX());
    space.add_rigid_motion(Vec3::Zero(), Vec3::UnitY());
    for (int k = 0; k < responses; ++k) {
        ReducedSpace::Response response = space.response(solver, uneven_load(network, k), 10);
        const double unit = max_displacement(response.displacement);
        REQUIRE(space.add(response, unit));
    }
}

Eigen::VectorXd uneven_freedoms(const ReducedSpace& space) {
    Eigen::VectorXd freedoms(space.stiffness().rows());
    for (Eigen::Index k = 0; k < freedoms.size(); ++k) freedoms[k] = 1e-11 * std::cos(2.5 * static_cast<double>(k));
    return freedoms;
}

}  // namespace

TEST_CASE("fields of a reduced space: rigid motions strain nothing, responses have their energy, none comes twice") {
    const BondNetwork network = rough_body().network;
    ElasticSolver solver(network, Ground::displacement_and_rotation);
    ReducedSpace space(network);
    fill(space, solver, network, 4);
    REQUIRE(space.fields() == 7);
    const Eigen::MatrixXd& stiffness = space.stiffness();
    CHECK(stiffness.topLeftCorner(4, 8).isZero(0.0));
    for (Eigen::Index a = 4; a < 8; ++a) {
        const Vector force = space.force(solver, Eigen::VectorXd::Unit(8, a));
        for (Eigen::Index b = 4; b < 8; ++b) {
            const double energy = linalg::dot(space.displacement(Eigen::VectorXd::Unit(8, b)), force);
            CHECK(std::abs(stiffness(a, b) - energy) < 1e-9 * std::sqrt(stiffness(a, a) * stiffness(b, b)));
        }
    }
    const Eigen::VectorXd freedoms = uneven_freedoms(space);
    CHECK(space.energy(freedoms) == relative(0.5 * linalg::dot(space.displacement(freedoms), space.force(solver, freedoms)), 1e-9));
    CHECK(space.energy(freedoms) == relative(energy_in_bonds(network, space.displacement(freedoms)), 1e-9));
    // A displacement of the space, next to nothing of another, and the unit of a displacement that moves no contact.
    ReducedSpace::Response again{space.displacement(freedoms), space.force(solver, freedoms), 0};
    CHECK_FALSE(space.add(again, 1e-11));
    const ReducedSpace::Response other = space.response(solver, uneven_load(network, 5), 10);
    for (std::size_t node = 0; node < network.nodes(); ++node) {
        again.displacement[node] += 1e-6 * other.displacement[node];
        again.force[node] += 1e-6 * other.force[node];
    }
    CHECK_FALSE(space.add(again, 1e-11));
    CHECK_FALSE(space.add(other, 0.0));
    CHECK(space.fields() == 7);
    CHECK(space.add(other, 1e-11));
}

TEST_CASE("fields that become one keep displacement, force and energy") {
    const BondNetwork network = rough_body().network;
    ElasticSolver solver(network, Ground::displacement_and_rotation);
    for (const std::size_t last : {5, 6, 7}) {
        ReducedSpace space(network);
        fill(space, solver, network, 4);
        const Eigen::VectorXd freedoms = uneven_freedoms(space);
        const Vector displacement = space.displacement(freedoms), force = space.force(solver, freedoms);
        const double energy = space.energy(freedoms), unit = 3e-12;
        space.join(solver, 3, last, space.sum(freedoms, 3, last), unit);
        REQUIRE(space.fields() == 3 + (7 - last) + 1);
        const auto left = static_cast<Eigen::Index>(7 - last);
        Eigen::VectorXd joined(4 + left + 1);
        joined << freedoms.head(4), freedoms.tail(left), unit;
        // A field has 48 bits a value.
        const double rounding = std::exp2(-37) * 10.0 * network.stiffness.front().normal * linalg::norm(displacement);
        CHECK(rounding < 1e-8 * linalg::norm(force));
        CHECK(space.energy(joined) == relative(energy, 1e-9));
        for (std::size_t node = 0; node < network.nodes(); ++node) {
            CHECK((space.displacement(joined)[node] - displacement[node]).norm() < 1e-12 * linalg::norm(displacement));
            CHECK((space.force(solver, joined)[node] - force[node]).norm() < rounding);
        }
    }
}

TEST_CASE("responses have no part of a rigid motion") {
    const BondNetwork network = rough_body().network;
    ElasticSolver solver(network, Ground::displacement_and_rotation);
    ReducedSpace space(network);
    fill(space, solver, network, 0);
    const Vector response = space.response(solver, uneven_load(network, 1), 10).displacement;
    for (std::size_t field = 0; field < 3; ++field) {
        Vector motion(network.nodes());
        for (std::size_t node = 0; node < network.nodes(); ++node) motion[node] = space.displacement(field, node);
        CHECK(std::abs(linalg::dot(motion, response)) < 1e-12 * linalg::norm(motion) * linalg::norm(response));
    }
}

TEST_CASE("a bond softened in the space is a bond softened in the network") {
    BondNetwork network = rough_body().network;
    ElasticSolver solver(network, Ground::displacement_and_rotation);
    ReducedSpace space(network);
    fill(space, solver, network, 3);
    const Eigen::VectorXd freedoms = uneven_freedoms(space);
    const Vector displacement = space.displacement(freedoms);
    const double before = space.energy(freedoms);
    const std::size_t bond = network.bonds() / 2;
    space.soften(bond, 0.25);
    solver.soften(network, bond, 0.25);
    physics::BondStiffness& k = network.stiffness[bond];
    k = {0.25 * k.normal, 0.25 * k.shear, 0.25 * k.torsion, 0.25 * k.bending};
    CHECK(space.energy(freedoms) < (1.0 - 1e-6) * before);
    CHECK(space.energy(freedoms) == relative(energy_in_bonds(network, displacement), 1e-9));
    CHECK(space.energy(freedoms) == relative(0.5 * linalg::dot(displacement, space.force(solver, freedoms)), 1e-9));
}

TEST_CASE("contacts resist with the derivative of their potential, and stiffen with the derivative of their resistance") {
    const BondedBody body = rough_body();
    const BondNetwork& network = body.network;
    ElasticSolver solver(network, Ground::displacement_and_rotation);
    std::vector<WallContact> walls;
    for (const std::int32_t node : {0, 4, 40, 77, 100}) {
        const bool punch = node == 40;
        const Vec3 normal = Vec3(0.2, 0.0, punch ? -1.0 : 1.0).normalized();
        walls.push_back({node, punch ? 2 : 0, punch, 0.0, normal, 4.5e-8, 4e11, 9e10});
    }
    for (const double friction : {0.0, 0.3}) {
        ReducedSpace space(network);
        fill(space, solver, network, 3);
        ContactSet contacts(network, walls, {}, friction);
        for (std::size_t field = 0; field < space.fields(); ++field) contacts.add_field(space, field);
        Eigen::VectorXd freedoms = Eigen::VectorXd::Zero(space.stiffness().rows());
        contacts.release(freedoms);
        freedoms = uneven_freedoms(space);
        freedoms[0] = 2e-10;
        freedoms[1] = -1e-10;
        contacts.follow(freedoms);
        const ContactSet::Forces forces = contacts.forces(freedoms);
        REQUIRE((forces.force.array() > 0.0).count() >= 4);
        const Eigen::VectorXd resistance = contacts.resistance(forces);
        Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(freedoms.size(), freedoms.size());
        contacts.add_stiffness(forces, freedoms, stiffness);
        const double step = 1e-14;
        for (Eigen::Index k = 0; k < freedoms.size(); ++k) {
            Eigen::VectorXd up = freedoms, down = freedoms;
            up[k] += step;
            down[k] -= step;
            const ContactSet::Forces above = contacts.forces(up), below = contacts.forces(down);
            CHECK(std::abs((above.potential - below.potential) / (2.0 * step) - resistance[k]) < 1e-6 * resistance.norm());
            const Eigen::VectorXd slope = (contacts.resistance(above) - contacts.resistance(below)) / (2.0 * step);
            CHECK((slope - stiffness.col(k)).norm() < 1e-5 * stiffness.norm());
        }
        // On the nodes the contacts do what they do to the freedoms.
        Vector nodes(network.nodes(), Vec6::Zero());
        contacts.add_to_nodes(forces, nodes);
        for (std::size_t field = 0; field < space.fields(); ++field) {
            const double work = linalg::dot(
                nodes, space.displacement(Eigen::VectorXd::Unit(freedoms.size(), static_cast<Eigen::Index>(field) + 1)));
            CHECK(std::abs(work + resistance[static_cast<Eigen::Index>(field) + 1]) < 1e-9 * resistance.norm());
        }
        CHECK(contacts.punch_force(forces) == relative(resistance[0], 1e-9));
    }
}
