// bar_files.h: bars of tests/data/bend, each of which once broke the balance of a bending test.
#pragma once

#include <string>

#include "io/files.h"
#include "io/state_io.h"

namespace kiln::test {

inline State bar_of_file(const std::string& name) {
    io::Input input({"tests/data/bend/" + name}, [] { return false; });
    return *input.next_state();
}

}  // namespace kiln::test
