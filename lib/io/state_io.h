// state_io.h: a state from a document and a document from a state; every rule about the names and values inside is here.
#pragma once

#include "core/state.h"
#include "io/document.h"

namespace kiln::io {

inline constexpr int format_version = 1;

/// Checks the document and moves its arrays into a state.
/// Throws PlacedError naming document, array and row: not dem-state, unknown version, units other than SI, wrong type or shape,
/// index out of range, NaN or infinity, radius <= 0, unknown material, box not orthogonal, repeated id or material, a bond of a
/// particle with itself.
/// Unknown keys of the document, its box and its contacts end in State::other, in the same places.
State state_from(Document document);

/// The state as a document; arrays are moved out of it. Throws Error that names array and row of a NaN or an infinity.
Document document_from(State state);

/// What a state's history says: a list, an entry for each program that it went through. Throws Error where it is no such list.
Json history_of(const State& state);

/// Adds an entry to the history of a state. Throws Error that names a number in it that is not finite.
void append_history(State& state, const Json& entry);

}  // namespace kiln::io
