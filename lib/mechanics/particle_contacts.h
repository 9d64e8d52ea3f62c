// particle_contacts.h: spheres without a bond between them that come to touch as the body deforms.
#pragma once

#include <vector>

#include "mechanics/bond_network.h"

namespace kiln::mechanics {

/// What a contact has to know of the particle at a node.
struct ElasticSphere {
    double radius;         // m
    double young_modulus;  // Pa
    double poisson_ratio;
};

/// The particles at the nodes of a body. Throws Error for missing material data.
std::vector<ElasticSphere> elastic_spheres(const State& state, const BondedBody& body);

/// Two nodes without a bond. Spheres that overlap at rest touch there without force.
struct PairContact {
    std::int32_t i, j;
    Vec3 vector;                // m, from i to j at rest
    double gap;                 // m, at rest, zero or more
    double radius;              // m, reduced
    double modulus;             // Pa, contact modulus
    double shear_modulus;       // Pa, the same for Mindlin's stiffness
    double radius_i, radius_j;  // m
};

/// The contact of two nodes, whether they are near each other or not.
PairContact contact_between(const BondNetwork& network, const std::vector<ElasticSphere>& spheres, std::int32_t i, std::int32_t j);

/// Pairs without a bond whose gap, under the displacements of the nodes, is less than the margin (m). Sorted by i, then j.
std::vector<PairContact> near_pairs(const BondNetwork& network, const std::vector<ElasticSphere>& spheres,
                                    const Vector& displacement, double margin);

}  // namespace kiln::mechanics
