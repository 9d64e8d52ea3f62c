// bond_network.cpp: from a state's bonds to springs, blocks and forces.
#include "mechanics/bond_network.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

#include "core/spatial_order.h"
#include "mechanics/connectivity.h"
#include "physics/materials.h"
#include "physics/solid_law.h"

namespace kiln::mechanics {

namespace {

using Mat3 = Eigen::Matrix3d;

std::size_t at(std::int64_t index) { return static_cast<std::size_t>(index); }

struct Moduli {
    double young, shear;  // Pa
};

std::vector<Moduli> moduli_of(const std::vector<Material>& materials) {
    std::vector<Moduli> moduli;
    for (const Material& material : materials) {
        const double young = physics::required(material.young_modulus, material, "young_modulus");
        const double poisson = physics::required(material.poisson_ratio, material, "poisson_ratio");
        moduli.push_back({young, young / (2.0 * (1.0 + poisson))});
    }
    return moduli;
}

double harmonic_mean(double a, double b) { return 2.0 * a * b / (a + b); }

Mat3 cross_matrix(const Vec3& v) {
    Mat3 matrix;
    matrix << 0.0, -v[2], v[1], v[2], 0.0, -v[0], -v[1], v[0], 0.0;
    return matrix;
}

/// Springs of a bond in space: for the relative displacement and the relative rotation at its middle.
struct BondTensor {
    Mat3 displacement, rotation;
};

BondTensor tensor_of(const BondNetwork& network, std::size_t bond) {
    const physics::BondStiffness& k = network.stiffness[bond];
    const Vec3 n = network.vector[bond].normalized();
    const Mat3 along = n * n.transpose();
    const Mat3 across = Mat3::Identity() - along;
    return {k.normal * along + k.shear * across, k.torsion * along + k.bending * across};
}

/// Bonds thick enough to carry anything.
std::vector<std::int32_t> carrying_bonds(const State& state) {
    std::vector<std::int32_t> rows;
    for (std::size_t bond = 0; bond < state.bonds->size(); ++bond) {
        const auto [i, j] = state.bonds->pair[bond];
        const double smaller = std::min(state.particles.radius[at(i)], state.particles.radius[at(j)]);
        if (state.bonds->radius[bond] > negligible_radius * smaller) rows.push_back(static_cast<std::int32_t>(bond));
    }
    return rows;
}

/// All particles along a space-filling curve.
std::vector<std::int32_t> along_curve(const State& state) {
    const std::vector<double>& radius = state.particles.radius;
    return spatial_order(state.box, state.particles.position,
                         std::accumulate(radius.begin(), radius.end(), 0.0) / static_cast<double>(radius.size()));
}

/// Part of each particle's surface under the caps of its bonds.
std::vector<double> coverage_of(const State& state, const std::vector<std::int32_t>& bonds) {
    std::vector<double> coverage(state.particles.size(), 0.0);
    for (const std::int32_t bond : bonds)
        for (const std::int32_t particle : state.bonds->pair[at(bond)])
            coverage[at(particle)] += physics::cap_share(state.particles.radius[at(particle)], state.bonds->radius[at(bond)]);
    return coverage;
}

void add_bond(BondedBody& body, const State& state, const std::vector<Moduli>& moduli, const std::vector<double>& coverage,
              std::int32_t row) {
    const Bonds& bonds = *state.bonds;
    const auto [first, second] = bonds.pair[at(row)];
    const Vec3 vector = bond_vector(state, bonds, at(row));
    if (vector.norm() == 0.0) {
        throw Error("bond " + std::to_string(row) + ": the centres of particles " + std::to_string(state.particles.id[at(first)]) +
                    " and " + std::to_string(state.particles.id[at(second)]) + " coincide");
    }
    const Moduli a = moduli[at(state.particles.material[at(first)])];
    const Moduli b = moduli[at(state.particles.material[at(second)])];
    body.network.pair.push_back(body.nodes_of(bonds, row));
    body.network.vector.push_back(vector);
    body.network.radius.push_back(
        std::min({bonds.radius[at(row)], state.particles.radius[at(first)], state.particles.radius[at(second)]}));
    const physics::BondGeometry geometry{state.particles.radius[at(first)], state.particles.radius[at(second)],
                                         vector.norm(),                     bonds.radius[at(row)],
                                         bonds.length[at(row)],             coverage[at(first)],
                                         coverage[at(second)]};
    body.network.stiffness.push_back(physics::bond_stiffness(*body.model.law,
                                                             body.model.shear.value_or(physics::BondShear::section),
                                                             harmonic_mean(a.young, b.young), harmonic_mean(a.shear, b.shear),
                                                             geometry));
}

}  // namespace

physics::BondLaw law_for(const State& state, const BondModel& model) {
    if (model.law) return *model.law;
    const bool necks = std::ranges::all_of(state.bonds->volume, [](double volume) { return volume == 0.0; });
    return necks ? physics::BondLaw::solid : physics::BondLaw::series;
}

BondedPiece largest_piece(const State& state) {
    if (!state.bonds || state.bonds->size() == 0) throw Error("the state has no bonds; run bondify first");
    const std::vector<std::int32_t> carrying = carrying_bonds(state);
    if (carrying.empty()) throw Error("no bond of the state is thick enough to carry a load");
    std::vector<std::array<std::int32_t, 2>> pairs;
    pairs.reserve(carrying.size());
    for (const std::int32_t row : carrying) pairs.push_back(state.bonds->pair[at(row)]);
    const std::vector<std::int32_t> order = along_curve(state);
    const Components pieces = find_components(order, pairs);
    const std::size_t largest = pieces.largest();

    BondedPiece body;
    body.negligible_bonds = state.bonds->size() - carrying.size();
    for (std::size_t piece = 0; piece < pieces.size(); ++piece) {
        if (piece == largest) continue;
        if (pieces.size(piece) == 1) {
            ++body.rattlers;
        } else {
            ++body.fragments;
            body.fragment_particles += pieces.size(piece);
        }
    }
    body.node.assign(state.particles.size(), -1);
    for (const std::int32_t particle : pieces.of(largest)) body.node[at(particle)] = 0;
    for (const std::int32_t particle : order) {
        if (body.node[at(particle)] < 0) continue;
        body.node[at(particle)] = static_cast<std::int32_t>(body.particle.size());
        body.particle.push_back(particle);
    }
    std::ranges::copy_if(carrying, std::back_inserter(body.bond),
                         [&](std::int32_t row) { return body.nodes_of(*state.bonds, row)[0] >= 0; });
    return body;
}

BondedBody bonded_body(const State& state, const BondModel& model) {
    if (!state.bonds || state.bonds->size() == 0) throw Error("the state has no bonds; run bondify first");
    const std::vector<Moduli> moduli = moduli_of(state.materials);
    BondedBody body{largest_piece(state), {}, {law_for(state, model), model.shear}};
    const bool solid = body.model.law == physics::BondLaw::solid;
    if (solid && model.shear)
        throw Error("the bonds are necks, and the law solid for them has a shear of its own: choose another law, or no shear");
    if (!solid) body.model.shear = model.shear.value_or(physics::BondShear::section);
    double radii = 0.0;
    for (const std::int32_t particle : body.particle) {
        body.network.position.push_back(state.box.wrap(state.particles.position[at(particle)]));
        radii += state.particles.radius[at(particle)];
    }
    body.network.rotation_length = radii / static_cast<double>(body.particle.size());
    for (int axis = 0; axis < 3; ++axis) {
        if (state.box.periodic[at(axis)]) body.network.period[axis] = state.box.lengths[axis];
    }
    const std::vector<double> coverage = coverage_of(state, body.bond);
    body.network.pair.reserve(body.bond.size());
    body.network.vector.reserve(body.bond.size());
    body.network.radius.reserve(body.bond.size());
    body.network.stiffness.reserve(body.bond.size());
    for (const std::int32_t row : body.bond) add_bond(body, state, moduli, coverage, row);
    return body;
}

Vec3 between(const BondNetwork& network, std::int32_t i, std::int32_t j) {
    Vec3 vector = network.position[at(j)] - network.position[at(i)];
    for (int axis = 0; axis < 3; ++axis) {
        const double period = network.period[axis];
        if (period > 0.0) vector[axis] -= period * std::round(vector[axis] / period);
    }
    return vector;
}

BondBlocks bond_blocks(const BondNetwork& network, std::size_t bond) {
    const BondTensor k = tensor_of(network, bond);
    const double length = network.rotation_length;
    const Mat3 S = cross_matrix(network.vector[bond]) / (2.0 * length);
    const Mat3& C = k.displacement;
    const Mat3 CS = C * S;
    const Mat3 SCS = S.transpose() * CS;
    const Mat3 rotation = k.rotation / (length * length);
    BondBlocks blocks;
    blocks.ii << C, -CS, -CS.transpose(), SCS + rotation;
    blocks.jj << C, CS, CS.transpose(), SCS + rotation;
    blocks.ij << -C, -CS, CS.transpose(), SCS - rotation;
    return blocks;
}

std::vector<linalg::Spring<double>> springs_of(const BondNetwork& network) {
    std::vector<linalg::Spring<double>> springs(network.bonds());
    for_rows(
        springs.size(),
        [&](std::size_t bond) {
            const physics::BondStiffness& k = network.stiffness[bond];
            const double length = network.rotation_length;
            const Vec3 arm = network.vector[bond] / (2.0 * length);
            const double square = arm.squaredNorm();
            springs[bond] = {network.pair[bond][0],
                             network.pair[bond][1],
                             {arm[0], arm[1], arm[2]},
                             k.shear,
                             (k.normal - k.shear) / square,
                             k.bending / (length * length),
                             (k.torsion - k.bending) / (length * length * square)};
        },
        worth_threads);
    return springs;
}

std::vector<BondLoad> bond_loads(const BondNetwork& network, const Vector& displacement) {
    std::vector<BondLoad> loads(network.bonds());
    for_rows(network.bonds(), [&](std::size_t bond) {
        const Vec6& first = displacement[at(network.pair[bond][0])];
        const Vec6& second = displacement[at(network.pair[bond][1])];
        const Vec3& d = network.vector[bond];
        const double length = network.rotation_length;
        const Vec3 twist = (first.tail<3>() + second.tail<3>()) / (2.0 * length);
        const Vec3 opening = second.head<3>() - first.head<3>() + d.cross(twist);
        const Vec3 turning = (second.tail<3>() - first.tail<3>()) / length;
        const BondTensor k = tensor_of(network, bond);
        loads[bond].force = k.displacement * opening;
        loads[bond].moment = k.rotation * turning;
        loads[bond].tension = loads[bond].force.dot(d.normalized());
    }, worth_threads);
    return loads;
}

physics::BondStress stress_of(const BondNetwork& network, std::size_t bond, const BondLoad& load) {
    const Vec3 along = network.vector[bond].normalized();
    const double torsion = load.moment.dot(along);
    return physics::bond_stress(load.tension, (load.force - load.tension * along).norm(), (load.moment - torsion * along).norm(),
                                std::abs(torsion), network.radius[bond]);
}

}  // namespace kiln::mechanics
