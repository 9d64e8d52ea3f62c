// spatial_order.h: an order of the particles in which neighbours in space are near each other in memory.
#pragma once

#include <span>
#include <vector>

#include "core/box.h"

namespace kiln {

/// Rows sorted along Morton's curve through cubic cells of the given edge (m); positions are wrapped first.
/// Equal cells keep their order.
std::vector<std::int32_t> spatial_order(const Box& box, std::span<const Vec3> position, double cell);

}  // namespace kiln
