// conduction.h: conductivity of a periodic cell of bonded particles.
#pragma once

#include "core/state.h"
#include "core/stop.h"

namespace kiln::mechanics {

/// What the solid and its grain boundaries are.
struct Conductor {
    double conductivity = 1.0;         // W/(m K)
    double boundary_resistance = 0.0;  // m2 K/W, of the grain boundary across every neck
};

struct Conductivity {
    Eigen::Matrix3d tensor;            // W/(m K)
    double bound = 0.0;                // W/(m K), Hashin & Shtrikman's upper bound without grain boundaries
    bool at_bound = false;             // the network would lie above it, and is scaled down to it
    double coordination_number = 0.0;  // bond ends of a particle of the piece
    std::size_t fragments = 0, rattlers = 0, negligible_bonds = 0;  // see BondedPiece
    int iterations = 0;
    double residual = 0.0;  // unbalanced flow over what drives it
    bool converged = false;
};

/// The largest piece of a state, periodic along all axes, whose solid fills a fraction of the box: a network of resistances by
/// physics/conduction.h, with particles that share that solid as their volumes are. Three gradients are solved for at once, by
/// conjugate gradients. Throws Error for a state without carrying bonds, a box with a free axis, or a piece that does not reach
/// through the box along all axes; Interrupted.
Conductivity conductivity(const State& state, double solid_fraction, const Conductor& conductor, double tolerance,
                          const StopRequest& stop = {});

}  // namespace kiln::mechanics
