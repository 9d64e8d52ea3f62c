// schedule_text.h: a temperature schedule as people write it.
#pragma once

#include <string>

#include "physics/schedule.h"

namespace kiln::io {

/// "25C 10K/min 1200C 1h 10K/min 25C": a temperature, then any number of ramps (a rate and the temperature that it leads to) and
/// holds (a time); a blank may stand before a unit. Starts at time 0. Throws TextError that names the word that does not fit.
physics::Schedule parse_schedule(const std::string& text);

}  // namespace kiln::io
