// array_types.h: the type names of the stream (f8, i4, …) and the C++ types behind them.
#pragma once

#include <string>

#include "core/array.h"

namespace kiln::io {

/// Gives an empty array the named type; false if the name is unknown.
bool set_type(Array& array, const std::string& name);

/// Type name of an array.
std::string type_name(const Array& array);

/// "[6000,3]", for messages; cut where it is long.
std::string shape_text(const std::vector<std::size_t>& shape);

/// "f8, f4, …" for messages.
std::string known_types();

}  // namespace kiln::io
