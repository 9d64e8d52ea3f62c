// json_forward.h: the name of Json, for headers that need no more; the whole of it takes a second and a half to compile.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace kiln {

using Json = nlohmann::ordered_json;

}  // namespace kiln
