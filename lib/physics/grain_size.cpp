// grain_size.cpp: sums over the grains.
#include "physics/grain_size.h"

#include <cmath>

#include "physics/sinter_contact.h"

namespace kiln::physics {

GrainSize grain_size(std::span<const double> radius, std::span<const Pair> pairs, std::span<const double> overlap) {
    GrainSize size{.grains = radius.size()};
    if (radius.empty()) return size;
    const auto count = static_cast<double>(radius.size());
    double sum = 0.0, squares = 0.0, cubes = 0.0;
    for (const double r : radius) {
        sum += r;
        squares += r * r;
        cubes += r * r * r;
    }
    const double mean = sum / count;
    double deviations = 0.0;
    for (const double r : radius) deviations += (r - mean) * (r - mean);
    double covered = 0.0;
    for (std::size_t row = 0; row < pairs.size(); ++row) {
        const double first = radius[static_cast<std::size_t>(pairs[row].i)],
                     second = radius[static_cast<std::size_t>(pairs[row].j)];
        covered += contact_radius_squared(overlap[row], reduced_radius(first, second)) *
                   (0.25 / (first * first) + 0.25 / (second * second));
    }
    size.mean_diameter = 2.0 * mean;
    size.mean_intercept = 4.0 / 3.0 * cubes / squares;
    size.scatter = std::sqrt(deviations / count) / mean;
    size.coverage = covered / count;
    return size;
}

}  // namespace kiln::physics
