// precompiled.h: what nearly every file of unit tests includes, compiled once; see lib/precompiled.h.
#include "lib/precompiled.h"

#include <nlohmann/json.hpp>
