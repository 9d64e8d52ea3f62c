// seating.h: how a bar comes to rest between its cylinders before any load bends it.
#pragma once

#include "bending/fixture.h"

namespace kiln::bending {

/// Turns the bar as a rigid body (about x and y, its middle stays) until the cylinders, pressed together by next to nothing, turn
/// it no further. Rough bars that are a few particles wide roll by tenths of a radian, so that small rotations do not describe it;
/// all that comes after begins from there. Positions of the specimen follow, and its `turn` and `moved`. Throws Error if the
/// bar finds no rest.
void seat_bar(Specimen& specimen, const Fixture& fixture, const Options& options);

}  // namespace kiln::bending
