// sphere_list.h: green bodies from spheres that another program, or a tomograph, has placed.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/state.h"
#include "packing/file_manner.h"

namespace kiln::packing {

struct SphereList {
    std::vector<Vec3> position;  // m
    std::vector<double> radius;  // m
};

/// The spheres of a table (io/csv.h): x, y, z and a radius or diameter, other columns are not read; also the text that Yade writes,
/// "#format x_y_z_r". Throws Error that names file and line: columns that are missing or not clear, lengths without a unit, radii
/// not above zero, several materials.
SphereList read_spheres(const std::string& file, const FileManner& manner);

struct SphereOptions {
    std::optional<Vec3> lengths;  // m, edges of the box; none: as long as the spheres reach
    std::optional<Vec3> origin;   // m, its lowest corner; none: zero, or where the spheres begin if there are no lengths
    std::array<bool, 3> periodic{false, false, false};
    double swell = 0.0;           // fraction by which all lengths but the radii shrink
};

/// The body of these spheres, in their order, with ids from 0, of one material that is not named yet.
/// Throws Error for no spheres, a box that does not hold the centres, a periodic axis without a length, and for spheres at one
/// place or one inside another, which name rows from 0.
State body_of(const SphereList& spheres, const SphereOptions& options);

/// How spheres overlap: h/(r_i + r_j) of the contacts.
struct Overlaps {
    std::size_t contacts = 0;
    double mean = 0.0, max = 0.0;
};
Overlaps overlaps_of(const State& state);

}  // namespace kiln::packing
