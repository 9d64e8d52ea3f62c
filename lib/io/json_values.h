// json_values.h: JSON and the values and texts in it.
#pragma once

#include <string>

#include "io/json.h"

namespace kiln::io {

/// A finite number >= lowest, or Error that starts with where.
double number_from(const Json& json, const std::string& where, double lowest);

/// Puts unknown keys back beside the known ones they stood with: into the objects of target, and those of its lists where the
/// lengths agree. What target has already stays.
void put_back(Json& target, const Json& carried);

/// JSON has no word for NaN and infinity, and the library would write null: throws Error that starts with where and names the key.
void check_finite(const Json& json, const std::string& where);

/// JSON as one line of text; what is no UTF-8 in it is replaced.
std::string text_of(const Json& json);

/// JSON of a text that a State carries; what: for the message of the Error thrown where it is none.
Json carried_json(const std::string& text, const std::string& what);

/// Text for a message, cut where it is long.
std::string clipped(const std::string& text);

/// JSON for a message, cut where it is long.
std::string shown(const Json& json);

}  // namespace kiln::io
