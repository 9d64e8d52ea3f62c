// report.h: the documents that bend writes.
#pragma once

#include "bending/result.h"

namespace kiln::bend {

/// What happened to the bar, for its history.
Json summary(const bending::Result& result);

/// The dem-bend document; history includes this run's entry.
Json document(const bending::Result& result, const bending::Options& options, Json history);

/// The bar under the greatest force: displaced particles with `displacement` (m) and `rotation` (rad); bonds with `force` (N, on
/// the first particle), `normal_force` (N, tension positive), `moment` (N m, on the first particle at the bond's middle) and the
/// greatest `tensile_stress` and `shear_stress` (Pa, see physics/bond_stress.h).
State bent_state(const bending::Result& result, Json history);

}  // namespace kiln::bend
