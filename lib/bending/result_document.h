// result_document.h: a bending test as a dem-bend document, and the bent bar as a state.
#pragma once

#include "bending/result.h"
#include "io/json_forward.h"

namespace kiln::bending {

/// What happened to the bar, for its history.
Json summary(const Result& result);

/// The dem-bend document.
Json document(const Result& result, const Options& options, const Json& history);

/// The bar under the greatest force: displaced particles with `displacement` (m) and `rotation` (rad); bonds with `force` (N, on
/// the first particle), `normal_force` (N, tension positive), `moment` (N m, on the first particle at the bond's middle) and the
/// greatest `tensile_stress` and `shear_stress` (Pa, see physics/bond_stress.h).
State bent_state(const Result& result);

}  // namespace kiln::bending
