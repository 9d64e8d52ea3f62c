// bond_network.h: a piece of bonded particles as a network of springs, its stiffness and the forces in its bonds.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "core/state.h"
#include "linalg/springs.h"
#include "physics/bond_law.h"
#include "physics/bond_stress.h"

namespace kiln::mechanics {

using linalg::Mat6, linalg::Vec6, linalg::Vector, linalg::worth_threads;

/// Nodes with six freedoms each: displacement (m) and rotation (rad) times rotation_length (m).
struct BondNetwork {
    std::vector<Vec3> position;  // m
    Vec3 period = Vec3::Zero();  // m, box length along a periodic axis, else 0
    std::vector<std::array<std::int32_t, 2>> pair;
    std::vector<Vec3> vector;    // m, from the first node to the second (or its image)
    std::vector<double> radius;  // m, of the bond, at most that of its smaller sphere
    std::vector<physics::BondStiffness> stiffness;
    double rotation_length = 1.0;  // m

    std::size_t nodes() const { return position.size(); }
    std::size_t bonds() const { return pair.size(); }
};

struct BondModel {
    std::optional<physics::BondLaw> law;      // none: that which fits the state, see law_for()
    std::optional<physics::BondShear> shear;  // none: section; the law solid takes none
};

/// The law of the model, or the one that fits a state with bonds: solid for necks, that is, where no bond adds a volume of its own
/// to that of the particles; else series.
physics::BondLaw law_for(const State& state, const BondModel& model);

/// The largest piece of a state that carrying bonds hold together, and what was left out of it.
struct BondedPiece {
    std::vector<std::int32_t> particle;  // node -> row of the state's particles
    std::vector<std::int32_t> node;      // row of the state's particles -> node; -1 outside
    std::vector<std::int32_t> bond;      // bond of the piece -> row of the state's bonds
    std::size_t fragments = 0;           // further pieces of two particles or more
    std::size_t fragment_particles = 0;  // in those
    std::size_t rattlers = 0;            // particles without a bond
    std::size_t negligible_bonds = 0;    // thinner than negligible_radius

    /// The nodes of a bond of the state.
    std::array<std::int32_t, 2> nodes_of(const Bonds& bonds, std::int32_t row) const {
        const auto [first, second] = bonds.pair[static_cast<std::size_t>(row)];
        return {node[static_cast<std::size_t>(first)], node[static_cast<std::size_t>(second)]};
    }
};

/// Nodes along a space-filling curve, so that most neighbours stand near each other. Throws Error for a state without bonds, or
/// whose bonds are all negligible.
BondedPiece largest_piece(const State& state);

/// The largest piece as a network of springs.
struct BondedBody : BondedPiece {
    BondNetwork network;
    BondModel model;  // with the law, and with the shear unless the law is solid
};

/// A bond thinner than this share of its smaller sphere's radius carries nothing: its bending stiffness is 1e-12 of a full one's.
inline constexpr double negligible_radius = 1e-3;

/// Network of the largest piece. Bonds between unlike materials take the harmonic means of their moduli. Throws Error for a state
/// without bonds or material data, centres that coincide, or a shear for the law solid.
BondedBody bonded_body(const State& state, const BondModel& model);

/// Node j relative to node i, m; the nearest image along periodic axes.
Vec3 between(const BondNetwork& network, std::int32_t i, std::int32_t j);

/// Blocks of one bond for its nodes i and j, N/m. With the relative displacement u_j - u_i + S (q_i + q_j) at the bond's middle,
/// S q = d x q/2 per rotation length, and the relative rotation q_j - q_i.
struct BondBlocks {
    Mat6 ii, ij, jj;
};

BondBlocks bond_blocks(const BondNetwork& network, std::size_t bond);

/// The same for products: a symmetric matrix, positive semidefinite, with zero energy for rigid motions of a free network and for
/// translations of a periodic one.
std::vector<linalg::Spring<double>> springs_of(const BondNetwork& network);

/// What a bond does to its second node is the opposite of `force`: tension pulls the first node along +vector.
struct BondLoad {
    Vec3 force;      // N, on the first node
    Vec3 moment;     // N m, at the bond's middle, on the first node
    double tension;  // N, along the bond, positive when it pulls
};

/// Loads of all bonds under a displacement field.
std::vector<BondLoad> bond_loads(const BondNetwork& network, const Vector& displacement);

/// Greatest stresses in a bond of the network under its load.
physics::BondStress stress_of(const BondNetwork& network, std::size_t bond, const BondLoad& load);

}  // namespace kiln::mechanics
