// structure.h: contacts, clusters and density of a state.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/contacts.h"
#include "core/state.h"

namespace kiln::analyze {

/// The bonds of a state that has them, else the pairs of particles that overlap.
std::vector<Pair> contacts_of(const State& state);

/// Mean over the contacts of (r1 + r2 - d)/(r1 + r2), which is h/2R for equal spheres; bonded spheres that stand apart count as 0.
double mean_overlap_ratio(const State& state, const std::vector<Pair>& contacts);

/// Particles of the largest group that hangs together by contacts, over all particles.
double largest_cluster_fraction(std::size_t particles, const std::vector<Pair>& contacts);

struct Density {
    std::optional<double> value;  // solid over total volume
    std::string measure;          // what volume: "box", "inner", or "none" where the body is too small to have an inside
};

/// Relative density, bonds included. Box: a state periodic along all axes. Inner, otherwise: along the free axes the region between
/// the outermost centres less a mean diameter on either side, at least three mean diameters wide; a particle counts whole if its
/// centre is inside, a bond by halves with its particles.
Density measured_density(const State& state);

}  // namespace kiln::analyze
