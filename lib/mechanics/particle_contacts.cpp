// particle_contacts.cpp: search for pairs that may touch.
#include "mechanics/particle_contacts.h"

#include <algorithm>
#include <cmath>

#include "core/neighbours.h"
#include "physics/hertz.h"
#include "physics/materials.h"

namespace kiln::mechanics {

namespace {

std::size_t at(std::int32_t index) { return static_cast<std::size_t>(index); }

std::vector<std::array<std::int32_t, 2>> sorted_bonds(const BondNetwork& network) {
    std::vector<std::array<std::int32_t, 2>> bonded;
    for (const auto& [i, j] : network.pair) bonded.push_back({std::min(i, j), std::max(i, j)});
    std::sort(bonded.begin(), bonded.end());
    return bonded;
}

}  // namespace

std::vector<ElasticSphere> elastic_spheres(const State& state, const BondedBody& body) {
    std::vector<ElasticSphere> spheres;
    for (const std::int32_t row : body.particle) {
        const Material& material = state.materials[at(state.particles.material[at(row)])];
        spheres.push_back({state.particles.radius[at(row)], physics::required(material.young_modulus, material, "young_modulus"),
                           physics::required(material.poisson_ratio, material, "poisson_ratio")});
    }
    return spheres;
}

PairContact contact_between(const BondNetwork& network, const std::vector<ElasticSphere>& spheres, std::int32_t i, std::int32_t j) {
    const ElasticSphere &a = spheres[at(i)], &b = spheres[at(j)];
    const Vec3 vector = between(network, i, j);
    using physics::contact_modulus, physics::contact_shear_modulus, physics::in_contact;
    return {i,
            j,
            vector,
            std::max(0.0, vector.norm() - a.radius - b.radius),
            in_contact(a.radius, b.radius),
            in_contact(contact_modulus(a.young_modulus, a.poisson_ratio), contact_modulus(b.young_modulus, b.poisson_ratio)),
            in_contact(contact_shear_modulus(a.young_modulus, a.poisson_ratio),
                       contact_shear_modulus(b.young_modulus, b.poisson_ratio)),
            a.radius,
            b.radius};
}

std::vector<PairContact> near_pairs(const BondNetwork& network, const std::vector<ElasticSphere>& spheres,
                                    const Vector& displacement, double margin) {
    std::vector<Vec3> place;
    std::vector<double> reach;
    for (std::size_t node = 0; node < network.nodes(); ++node) {
        place.emplace_back(network.position[node] + displacement[node].head<3>());
        reach.push_back(spheres[node].radius + margin / 2.0);
    }
    Box box;
    for (int axis = 0; axis < 3; ++axis) {
        box.periodic[static_cast<std::size_t>(axis)] = network.period[axis] > 0.0;
        if (network.period[axis] > 0.0) box.lengths[axis] = network.period[axis];
    }
    const std::vector<std::array<std::int32_t, 2>> bonded = sorted_bonds(network);
    std::vector<PairContact> contacts;
    for (const Pair& pair : find_pairs(box, place, reach)) {
        if (std::binary_search(bonded.begin(), bonded.end(), std::array{pair.i, pair.j})) continue;
        contacts.push_back(contact_between(network, spheres, pair.i, pair.j));
    }
    return contacts;
}

}  // namespace kiln::mechanics
