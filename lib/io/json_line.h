// json_line.h: the JSON of one line, read within limits that keep a hostile line harmless.
#pragma once

#include <string>
#include <string_view>

#include "io/json_forward.h"

namespace kiln::io {

inline constexpr std::size_t deepest_nesting = 64;  // the JSON library copies and frees by recursion
inline constexpr std::size_t max_keys = 1024;      // of one object, which the JSON library searches key by key

/// JSON of a line, keys in their order. Time and memory grow in proportion to the line.
/// Throws Error that starts with place: no JSON or no UTF-8, a number too large, a key that stands twice in its object, more
/// nesting or keys than above.
Json parse_line(std::string_view line, const std::string& place);

}  // namespace kiln::io
