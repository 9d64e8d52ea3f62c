// specimen.h: the bar that is cut from a state.
#pragma once

#include "core/state.h"
#include "mechanics/bond_network.h"

namespace kiln::bending {

/// The bar along x, with its width along y and its height along z, m.
struct Specimen {
    State state;                    // the bar in a box without periodic faces
    mechanics::BondedBody body;     // its largest piece
    std::size_t dropped_bonds = 0;  // that went through opened faces
    double relative_density = 0.0;  // of the state it was cut from
    Vec3 origin, size;              // m, of the bar: the box along periodic axes, else what bonded particles reach
    double young_modulus = 0.0;     // Pa, of the solid that most particles are made of
    double poisson_ratio = 0.0;     // of the same
    std::string solid;              // its name
    Vec3 turn = Vec3::Zero();       // rad, by which it was turned to rest on the cylinders, see seat_bar; in sum
    std::vector<Vec3> moved;        // m, the same of every node
};

/// The state opened along its periodic axes: particles wrapped into the box, bonds through its faces dropped.
/// Returns the number of those.
std::size_t cut_open(State& state);

/// Throws Error for a state that cannot be made a bar: see mechanics::bonded_body.
Specimen cut_specimen(State state, const mechanics::BondModel& model);

}  // namespace kiln::bending
