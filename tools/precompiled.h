// precompiled.h: what nearly every file of the programs includes, compiled once; see lib/precompiled.h.
#include "lib/precompiled.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
