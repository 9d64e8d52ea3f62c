// periodic_grid.h: fields on a periodic grid of nodes, one float a node and component, laid out for vector units.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "core/parallel.h"
#include "core/types.h"

namespace kiln::linalg {

/// Nodes of a periodic grid. Rows along x are padded to whole cache lines and planes to an odd number of them, so that columns
/// along z do not fall on the same lines of a cache.
struct PeriodicGrid {
    static constexpr std::size_t line = 16;  // floats in a cache line

    PeriodicGrid(const std::array<std::size_t, 3>& nodes, const Vec3& edges)
        : count(nodes), spacing(edges), row((nodes[0] + line - 1) / line * line),
          plane(row * nodes[1] / line % 2 == 0 ? row * nodes[1] + line : row * nodes[1]) {}

    std::array<std::size_t, 3> count;  // along x, y, z
    Vec3 spacing;                      // of the nodes along x, y, z, in any one unit
    std::size_t row, plane;            // floats from one row to the next, from one plane to the next

    std::size_t nodes() const { return count[0] * count[1] * count[2]; }
};

/// Floats for some components of a field, plane after plane and component after component; zero at first, and always in the
/// padding.
class GridField {
   public:
    GridField() = default;
    GridField(const PeriodicGrid& grid, std::size_t components, std::size_t planes)
        : component_(grid.plane * planes), lines_(component_ * components / PeriodicGrid::line) {}

    float* component(std::size_t index) { return lines_.data()->value + index * component_; }
    const float* component(std::size_t index) const { return lines_.data()->value + index * component_; }

    /// All floats of all components, padding included.
    float* data() { return component(0); }
    const float* data() const { return component(0); }
    std::size_t size() const { return lines_.size() * PeriodicGrid::line; }

   private:
    struct alignas(64) Line {
        float value[PeriodicGrid::line];
    };
    std::size_t component_ = 0;
    std::vector<Line> lines_;
};

/// Floats that a sum or an update of a field takes at a time.
inline constexpr std::size_t field_chunk = 1 << 16;

/// Sum of value(i) for i from begin to end, a multiple of eight apart, in double precision.
template <typename Value>
double lane_sum(std::size_t begin, std::size_t end, const Value& value) {
    constexpr std::size_t lanes = 8;
    std::array<double, lanes> sums{};
    for (std::size_t i = begin; i < end; i += lanes)
        for (std::size_t lane = 0; lane < lanes; ++lane) sums[lane] += value(i + lane);
    double total = 0.0;
    for (const double sum : sums) total += sum;
    return total;
}

/// The same over the floats of a field of the given size, by threads.
template <typename Value>
double sum_floats(std::size_t size, const Value& value) {
    return sum_chunks((size + field_chunk - 1) / field_chunk, 0.0, [&](std::size_t chunk) {
        return lane_sum(chunk * field_chunk, std::min(size, (chunk + 1) * field_chunk), value);
    });
}

/// a . b of two fields of one size.
inline double dot(const GridField& a, const GridField& b) {
    const float *x = a.data(), *y = b.data();
    return sum_floats(a.size(), [=](std::size_t i) { return static_cast<double>(x[i]) * static_cast<double>(y[i]); });
}

}  // namespace kiln::linalg
