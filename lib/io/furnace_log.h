// furnace_log.h: a temperature schedule from the table that a furnace, or its controller, has logged.
#pragma once

#include <string>

#include "physics/schedule.h"

namespace kiln::io {

/// Headings that a user has chosen; empty: none.
struct LogColumns {
    std::string time, temperature;
};

/// The temperatures of a table (io/csv.h) with a straight line from each row to the next, from time 0 at the first row. Times are
/// numbers with a unit, or of the clock, as 10:03:22, 2026-11-25 10:03:22 or 25.11.2026 10:03, also with the date in a column of
/// its own. Rows within a hold, which change nothing, are left out. Throws Error that names file and line: columns that are
/// missing or not clear, a temperature without unit, times that go back, temperatures colder than a room's, and a table of one
/// row.
physics::Schedule read_schedule(const std::string& file, const LogColumns& columns = {});

}  // namespace kiln::io
