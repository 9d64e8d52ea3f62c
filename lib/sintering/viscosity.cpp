// viscosity.cpp: three linear solves on the contact network, one for a unit strain rate along each axis.
#include "sintering/viscosity.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sintering/force_balance.h"
#include "sintering/kinetics.h"
#include "sintering/rigid_clusters.h"
#include "sintering/sintering_body.h"
#include "sintering/tangent_solver.h"

namespace kiln::sintering {

namespace {

constexpr double accuracy = 1e-7;        // of the motions, energy norm; the viscosities' error is the square of that
constexpr double balance = 1e-4;         // of the forces on a particle or a cluster
constexpr int max_iterations = 20000;
constexpr double min_overlap = 1e-3;     // of the reduced radius, see viscosity.h
constexpr double coarse_contrast = 30.0; // of diffusion, that makes a coarse space pay

/// Touching contacts of a state as the nodes see them; viscosities times Delta of the fastest pair.
struct Contacts {
    std::vector<Pair> pairs;
    std::vector<Vec3> branch, normals;                       // m; unit vectors
    std::vector<double> force, normal, tangential, slowness; // N; viscosities; Delta of the fastest pair over that of this one
};

Contacts contacts_of(const SinteringBody& body, const Kinetics& kinetics, const physics::ContactConstants& constants,
                     const std::vector<double>& slowness, const RigidClusters& clusters) {
    Contacts contacts;
    for (const RigidClusters::NodePair& seen : clusters.node_pairs(body.pairs())) {
        const Pair& pair = body.pairs()[seen.row];
        const Vec3 vector = body.vector(pair);
        const auto [first, second] = body.radii(pair);
        const double overlap = body.overlap(pair);
        const std::size_t kind = kinetics.row(body.particles(), pair);
        if (overlap < 0.0 || kinetics.rigid(kind)) continue;
        const double reduced = physics::reduced_radius(first, second), aged = std::max(overlap, min_overlap * reduced);
        contacts.pairs.push_back(seen.pair);
        contacts.branch.push_back(pair_vector(body.box(), clusters.places(), seen.pair));
        contacts.normals.emplace_back((seen.reversed ? -1.0 : 1.0) * vector.normalized());
        contacts.force.push_back(physics::sintering_force(constants, reduced, kinetics.surface_energy(kind)));
        contacts.normal.push_back(physics::normal_viscosity_factor(constants, reduced) * physics::viscosity_shape(aged) *
                                  slowness[kind]);
        contacts.tangential.push_back(physics::tangential_viscosity(constants, aged, reduced) * slowness[kind]);
        contacts.slowness.push_back(slowness[kind]);
    }
    return contacts;
}

std::vector<Pair> sticking_pairs(const SinteringBody& body, const Kinetics& kinetics) {
    std::vector<Pair> sticking;
    for (const Pair& pair : body.pairs())
        if (sticks(body, kinetics, pair)) sticking.push_back(pair);
    return sticking;
}

/// Motions of a packing under strain rates of its box.
class Response {
   public:
    Response(const Box& box, std::span<const Vec3> position, const Contacts& contacts)
        : contacts_(contacts),
          network_(box, position, contacts.pairs),
          coarse_(coarse_spaces(box, position, contacts.pairs, contacts.slowness, coarse_contrast)),
          solver_(box, network_, contacts.pairs, coarse_),
          total_(network_.particles()) {
        for (const double value : contacts.normal) unit_ = std::max(unit_, value);
        for (std::size_t entry = 0; entry < network_.pair.size(); ++entry) {
            const auto row = static_cast<std::size_t>(network_.pair[entry]);
            solver_.springs().set_direction(entry, contacts.normals[row]);
            solver_.springs().set(entry, contacts.normal[row] / unit_, contacts.tangential[row] / unit_);
        }
        solver_.factorise(contacts.branch);
    }

    struct Field {
        Motion motion, forces;  // forces over the largest viscosity
        int iterations = 0;
        bool converged = false;
    };

    /// The motion in which nothing but the box holds the particles against the strain rate.
    Field under(const Vec3& strain_rate, const StopRequest& stop) {
        Field field{Motion(network_.particles()), Motion(network_.particles())};
        field.motion.strain = strain_rate;
        std::vector<double> exerted(contacts_.pairs.size());
        double scale = 0.0;  // square of the energy norm of the motion in which all particles follow the box
        for (std::size_t row = 0; row < exerted.size(); ++row) {
            const Vec3 motion = strain_rate.cwiseProduct(contacts_.branch[row]);
            const double along = contacts_.normals[row].dot(motion);
            const Vec3 force = (contacts_.tangential[row] * motion +
                                (contacts_.normal[row] - contacts_.tangential[row]) * along * contacts_.normals[row]) / unit_;
            exerted[row] = force.norm();
            scale += force.dot(motion);
        }
        Motion unbalanced(network_.particles()), correction(network_.particles());
        double sufficient = accuracy * accuracy * scale;
        for (int pass = 0; pass < max_passes; ++pass, sufficient *= sharpening) {
            find_forces(field);
            unbalanced.displacement = field.forces.displacement;
            field.converged = false;
            for (double& component : unbalanced.displacement) component = -component;
            const linalg::CgProgress solve = solver_.solve(
                Eigen::Matrix3d::Zero(), unbalanced, correction, [&](const linalg::CgProgress& progress) {
                    throw_if_stopped(stop);
                    return progress.error2 <= sufficient || progress.iterations >= max_iterations;
                });
            field.iterations += solve.iterations;
            add(network_, 1.0, correction, field.motion);
            find_forces(field);
            field.converged = solve.error2 <= sufficient &&
                              max_imbalance(network_, contacts_.pairs, exerted, coarse_, field.forces) <= balance;
            if (field.converged) break;
        }
        return field;
    }

    double unit() const { return unit_; }

    /// Sum over the contacts of the sintering force times the approach of the pair in a motion, with its sign turned.
    double work_of_sintering(const Motion& motion) {
        Motion forces(network_.particles());
        network_.gather(motion, forces, total_, [&](std::size_t entry, const Vec3&) -> Vec3 {
            const auto row = static_cast<std::size_t>(network_.pair[entry]);
            return contacts_.force[row] * contacts_.normals[row];
        });
        return dot(network_, forces, motion);
    }

    double product(const Motion& a, const Motion& b) const { return dot(network_, a, b); }

   private:
    static constexpr int max_passes = 8;
    static constexpr double sharpening = 1e-2;  // of the square of the error, where soft contacts beside stiff ones are unbalanced

    void find_forces(Field& field) {
        network_.gather(field.motion, field.forces, total_, [&](std::size_t entry, const Vec3& du) -> Vec3 {
            const auto row = static_cast<std::size_t>(network_.pair[entry]);
            const double along = contacts_.normals[row].dot(du);
            return ((contacts_.normal[row] - contacts_.tangential[row]) * along * contacts_.normals[row] +
                    contacts_.tangential[row] * du) / unit_;
        });
    }

    const Contacts& contacts_;
    ContactNetwork network_;
    std::vector<RigidClusters> coarse_;
    TangentSolver<double> solver_;
    std::vector<linalg::WideQuad> total_;
    double unit_ = 0.0;  // the largest viscosity
};

}  // namespace

ViscousResponse viscous_response(const State& state, const physics::ContactConstants& constants, double temperature,
                                 const StopRequest& stop) {
    for (const bool axis : state.box.periodic)
        if (!axis) throw Error("viscosities are those of a box that is periodic along all axes");
    const SinteringBody body(state, Faces::as_given);
    const Kinetics kinetics(state, physics::Schedule::hold(temperature));
    const RigidClusters clusters(body.box(), body.particles().position, sticking_pairs(body, kinetics));
    const Contacts contacts = contacts_of(body, kinetics, constants, kinetics.slowness_at(temperature), clusters);
    ViscousResponse response;
    response.locked = clusters.locked();
    for (int axis = 0; axis < 3; ++axis)
        if (response.locked[static_cast<std::size_t>(axis)]) {
            response.viscosity.row(axis).setConstant(std::numeric_limits<double>::infinity());
            response.viscosity.col(axis).setConstant(std::numeric_limits<double>::infinity());
        }
    if (contacts.pairs.empty()) return response;

    Response packing(body.box(), clusters.places(), contacts);
    std::vector<int> free;
    std::vector<Response::Field> fields;  // of the free axes
    for (int axis = 0; axis < 3; ++axis) {
        if (response.locked[static_cast<std::size_t>(axis)]) continue;
        free.push_back(axis);
        fields.push_back(packing.under(Vec3::Unit(axis), stop));
        response.conjugate_gradients += fields.back().iterations;
        response.converged = response.converged && fields.back().converged;
    }
    // The work of one field's forces in another's motion: symmetric and positive by construction, and its error is the product of
    // the errors of both fields. The sintering stress is the work of the sintering forces in the same motions (reciprocity).
    const double volume = body.box().volume();
    for (std::size_t row = 0; row < free.size(); ++row) {
        response.sintering_stress[free[row]] = packing.work_of_sintering(fields[row].motion) / volume;
        for (std::size_t column = 0; column < free.size(); ++column) {
            const double work = 0.5 * (packing.product(fields[row].motion, fields[column].forces) +
                                       packing.product(fields[column].motion, fields[row].forces));
            response.viscosity(free[row], free[column]) = work * (packing.unit() / volume) / kinetics.fastest();
        }
    }
    return response;
}

}  // namespace kiln::sintering
