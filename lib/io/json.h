// json.h: the JSON of the stream, keys in the order in which they stand.
#pragma once

#include <nlohmann/json.hpp>

namespace kiln {

using Json = nlohmann::ordered_json;

}  // namespace kiln
