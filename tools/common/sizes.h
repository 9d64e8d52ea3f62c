// sizes.h: what programs say of the sizes of particles.
#pragma once

#include <functional>
#include <vector>

#include "io/json_forward.h"

namespace kiln::cli {

/// {"by_number": {"d10", "d50", "d90"}, "by_volume": {…}}, m: the diameters below which a tenth, half and nine tenths lie.
/// quantile: of a fraction, by volume or by number.
Json percentiles_json(const std::function<double(double fraction, bool by_volume)>& quantile);

/// The same of particles with these diameters, m; there is at least one.
Json percentiles_json(const std::vector<double>& diameters);

}  // namespace kiln::cli
