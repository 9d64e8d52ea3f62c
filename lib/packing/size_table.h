// size_table.h: size distributions from files: lists of diameters, and tables as sieves and laser diffraction export them.
#pragma once

#include <optional>
#include <string>

#include "packing/size_distribution.h"

namespace kiln::packing {

/// The distribution in a file. Either one diameter a line, each with its unit, or a table (io/csv.h) of a diameter and a share:
/// - The heading of the shares says volume, mass or number, else `weighting` has to; percent, fractions of one, or counts.
/// - It says cumulative, undersize, passing or oversize, else `shares` has to, unless their sum or their last makes it plain.
/// - A class has the one diameter of its row; with "lower" or "upper" in the heading, or with both columns, it lies between edges.
/// - A cumulative curve begins at 0 and ends at 100 %, to 0.1 %.
/// Or a table of one row with D10, D50 and D90. Throws Error that names file and line for anything else.
SizeDistribution read_sizes(const std::string& file, std::optional<Weighting> weighting, std::optional<Shares> shares,
                            const FileManner& manner);

}  // namespace kiln::packing
