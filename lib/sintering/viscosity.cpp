// viscosity.cpp: four linear solves on the contact network, one without strain and one for each axis.
#include "sintering/viscosity.h"

#include <algorithm>

#include "sintering/conjugate_gradients.h"
#include "sintering/kinetics.h"
#include "sintering/sintering_body.h"
#include "sintering/rigid_clusters.h"

namespace kiln::sintering {

namespace {

constexpr double accuracy = 1e-7;       // of the solves, energy norm
constexpr int most_iterations = 20000;
constexpr double least_overlap = 1e-3;  // of the reduced radius, see viscosity.h
constexpr double pass_accuracy = 1e-3;  // of one solve, which is in single precision; refinement takes up what it leaves
constexpr int most_refinements = 20;

/// Touching contacts of a state as the nodes see them; viscosities over `unit`, which makes them plain numbers near one.
struct Contacts {
    std::vector<Pair> pairs;
    std::vector<Vec3> levers, normals;              // m; unit vectors
    std::vector<double> force, normal, tangential;  // N; viscosities
    double unit = 0.0;                              // N s/m

    /// Square of the energy norm of the contact forces under affine motion, by which accuracy is measured: in a lattice they cancel
    /// on every particle, and what is left to solve for is rounding.
    double square_under(const Vec3& strain_rate, double drive) const {
        double sum = 0.0;
        for (std::size_t row = 0; row < pairs.size(); ++row) {
            const double pull = drive * force[row] + normal[row] * normals[row].dot(strain_rate.cwiseProduct(levers[row]));
            sum += pull * pull / (normal[row] * unit);
        }
        return sum;
    }
};

Contacts contacts_of(const SinteringBody& packing, const Kinetics& kinetics, const physics::ContactConstants& constants,
                     const std::vector<double>& diffusion, const RigidClusters& clusters) {
    Contacts contacts;
    for (const Pair& pair : packing.pairs()) {
        const Vec3 vector = packing.vector(pair);
        const auto [first, second] = packing.radii(pair);
        const double overlap = first + second - vector.norm();
        bool turned = false;
        const Pair seen = clusters.seen(pair, turned);
        if (overlap < 0.0 || RigidClusters::inert(seen)) continue;
        const std::size_t kind = kinetics.row(packing.particles(), pair);
        if (kinetics.rigid(kind)) continue;
        const double reduced = physics::reduced_radius(first, second), aged = std::max(overlap, least_overlap * reduced);
        contacts.pairs.push_back(seen);
        contacts.levers.push_back(pair_vector(packing.box(), clusters.places(), seen));
        contacts.normals.emplace_back((turned ? -1.0 : 1.0) * vector.normalized());
        contacts.force.push_back(physics::sintering_force(constants, reduced, kinetics.surface_energy(kind)));
        contacts.normal.push_back(physics::normal_viscosity_factor(constants, reduced) * aged * aged / diffusion[kind]);
        contacts.tangential.push_back(physics::tangential_viscosity(constants, aged, reduced) / diffusion[kind]);
    }
    for (const double value : contacts.normal) contacts.unit = std::max(contacts.unit, value);
    return contacts;
}

Stiffness stiffness_of(const ContactNetwork& network, const Contacts& contacts) {
    Stiffness stiffness(network);
    for (std::size_t entry = 0; entry < network.pair.size(); ++entry) {
        const auto row = static_cast<std::size_t>(network.pair[entry]);
        stiffness.set_direction(entry, contacts.normals[row]);
        stiffness.set(entry, contacts.normal[row] / contacts.unit, contacts.tangential[row] / contacts.unit);
    }
    return stiffness;
}

std::vector<Pair> sticking_pairs(const SinteringBody& packing, const Kinetics& kinetics) {
    std::vector<Pair> sticking;
    for (const Pair& pair : packing.pairs())
        if (sticks(packing, kinetics, pair)) sticking.push_back(pair);
    return sticking;
}

}  // namespace

ViscousResponse viscous_response(const State& state, const physics::ContactConstants& constants, double temperature) {
    for (const bool axis : state.box.periodic)
        if (!axis) throw Error("viscosities are those of a box that is periodic along all axes");
    const SinteringBody packing(state, Faces::as_given);
    const Kinetics kinetics(state, physics::Schedule::hold(temperature));
    const RigidClusters clusters(packing.box(), packing.particles().position, sticking_pairs(packing, kinetics));
    Contacts contacts = contacts_of(packing, kinetics, constants, kinetics.diffusion_at(temperature), clusters);
    ViscousResponse response;
    if (contacts.pairs.empty()) return response;

    const ContactNetwork network(packing.box(), clusters.places(), contacts.pairs);
    const Stiffness stiffness = stiffness_of(network, contacts);
    Preconditioner preconditioner(network);
    preconditioner.factorise(stiffness, contacts.levers);
    ConjugateGradients solver(network.particles());
    std::vector<double> total(3 * network.particles());
    const auto stress_under = [&](const Vec3& strain_rate, double drive) -> Vec3 {
        Motion motion(network.particles()), forces(network.particles()), correction(network.particles());
        motion.strain = strain_rate;
        const auto unbalanced = [&] {
            network.gather(motion, forces, total, [&](std::size_t entry, const Vec3& du) -> Vec3 {
                const auto row = static_cast<std::size_t>(network.pair[entry]);
                const double along = contacts.normals[row].dot(du);
                return (drive * contacts.force[row] + (contacts.normal[row] - contacts.tangential[row]) * along) / contacts.unit *
                           contacts.normals[row] +
                       contacts.tangential[row] / contacts.unit * du;
            });
        };
        const double enough = accuracy * accuracy * contacts.square_under(strain_rate, drive);
        for (int pass = 0; pass < most_refinements; ++pass) {
            unbalanced();
            for (double& component : forces.displacement) component = -component;
            forces.strain.setZero();
            const LinearGoal goal{.loosest = pass_accuracy, .tightest = pass_accuracy, .enough = enough,
                                  .most_iterations = most_iterations};
            const LinearSolve solve = solver.solve(stiffness, preconditioner, Eigen::Matrix3d::Zero(), forces, correction, goal);
            response.conjugate_gradients += solve.iterations;
            response.converged = solve.start <= enough;
            if (response.converged) break;
            add(network, 1.0, correction, motion);
        }
        unbalanced();
        return contacts.unit / packing.box().volume() * forces.strain;
    };
    response.sintering_stress = stress_under(Vec3::Zero(), 1.0);
    for (int axis = 0; axis < 3; ++axis) response.viscosity.col(axis) = stress_under(Vec3::Unit(axis), 0.0);
    return response;
}

}  // namespace kiln::sintering
