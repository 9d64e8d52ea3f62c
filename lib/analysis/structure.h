// structure.h: contacts, clusters and density of a state.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/contacts.h"
#include "core/state.h"
#include "physics/grain_size.h"

namespace kiln::analysis {

/// The bonds of a state that has them, else the pairs of particles that overlap or whose neck is recorded.
std::vector<Pair> contacts_of(const State& state);

/// Of each contact h/(r1 + r2), which is h/2R for equal spheres, h being r1 + r2 - d, or what the recorded neck says; bonded
/// spheres that stand apart count as 0. contacts: those of contacts_of().
std::vector<double> overlap_ratios(const State& state, const std::vector<Pair>& contacts);

/// Sizes of the particles as grains; a neck is that of a bond, else of a contact.
physics::GrainSize grain_size(const State& state);

/// Sizes of the groups that hang together by contacts, the largest first; a particle alone is a group of one.
std::vector<std::size_t> cluster_sizes(std::size_t particles, const std::vector<Pair>& contacts);

/// Mean of n n^T over the directions n of the contacts: trace 1, a third of the unit matrix without texture; zero without contacts.
/// (M. Satake, in: Deformation and Failure of Granular Materials, Balkema 1982, 63)
Eigen::Matrix3d fabric_tensor(const State& state, const std::vector<Pair>& contacts);

/// Mean diameter of the particles, m; zero without particles.
double mean_diameter(const Particles& particles);

enum class Measure { automatic, box, inner, envelope };

struct Density {
    std::optional<double> value;  // solid over total volume
    std::string measure;  // what volume: "box", "inner", "envelope", or "none" where the body is too small to have an inside
};

/// Relative density, bonds included.
/// box: the volume of the box. inner: along the free axes the region between the outermost centres less a mean diameter on either
/// side, at least three mean diameters wide; a particle counts whole if its centre is inside, a bond by halves with its particles.
/// envelope: see envelope.h; probe is the radius of its ball, m, zero for the mean diameter. automatic: box for a state periodic
/// along all axes, else inner. Throws Error for an envelope of a state without a free axis.
Density measured_density(const State& state, Measure measure = Measure::automatic, double probe = 0.0);

}  // namespace kiln::analysis
