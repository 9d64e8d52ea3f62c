// file_manner.h: what a user says of a file of sizes or spheres that does not say so itself.
#pragma once

#include <string>
#include <vector>

namespace kiln::packing {

/// What the shares of a table are of: each class, all that is smaller than the diameter in their row, or all that is larger.
enum class Shares { classes, undersize, oversize };

struct FileManner {
    std::vector<std::string> columns;  // names of the file's columns in their order, "-" for one not to be read; none: its headings
    std::string unit;                  // of lengths in columns that state none
};

}  // namespace kiln::packing
