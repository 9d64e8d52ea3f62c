// envelope.cpp: distances to the particles on a grid, the places that a ball reaches from outside, and the volume it leaves.
#include "analysis/envelope.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

namespace kiln::analysis {

namespace {

constexpr double max_points = 2e8;
constexpr std::size_t few_particles = 100;

using Index = std::array<int, 3>;

/// Points at the middle of cells that fill the body's bounding box, grown along free axes so far that a ball fits outside it.
struct Grid {
    Vec3 origin;  // of the first point
    Vec3 step;
    Index points;
    std::array<bool, 3> periodic;

    std::size_t size() const {
        return static_cast<std::size_t>(points[0]) * static_cast<std::size_t>(points[1]) * static_cast<std::size_t>(points[2]);
    }
    std::size_t at(const Index& index) const {
        return (static_cast<std::size_t>(index[0]) * static_cast<std::size_t>(points[1]) + static_cast<std::size_t>(index[1])) *
                   static_cast<std::size_t>(points[2]) +
               static_cast<std::size_t>(index[2]);
    }
    Index index_of(std::size_t point) const {
        const auto z = static_cast<std::size_t>(points[2]), y = static_cast<std::size_t>(points[1]);
        return {static_cast<int>(point / z / y), static_cast<int>(point / z % y), static_cast<int>(point % z)};
    }
    /// The index inside the grid, wrapped along periodic axes; false beyond a free face.
    bool inside(Index& index) const {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (periodic[axis]) index[axis] = (index[axis] % points[axis] + points[axis]) % points[axis];
            if (index[axis] < 0 || index[axis] >= points[axis]) return false;
        }
        return true;
    }
};

Grid grid_for(const State& state, double probe, double spacing) {
    const Particles& particles = state.particles;
    Grid grid{{}, {}, {}, state.box.periodic};
    double count = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        double low = state.box.origin[axis], length = state.box.lengths[axis];
        if (!grid.periodic[a]) {
            double high = -std::numeric_limits<double>::infinity();
            low = -high;
            for (std::size_t row = 0; row < particles.size(); ++row) {
                low = std::min(low, particles.position[row][axis] - particles.radius[row]);
                high = std::max(high, particles.position[row][axis] + particles.radius[row]);
            }
            const double margin = probe + 2.0 * spacing;  // the ball's centre has a free layer of points all around
            low -= margin;
            length = high + margin - low;
        }
        const double points = std::max(1.0, std::ceil(length / spacing));
        count *= points;
        if (count > max_points) throw Error("the particles are too far apart for an envelope");
        grid.points[a] = static_cast<int>(points);
        grid.step[axis] = length / points;
        grid.origin[axis] = low + 0.5 * grid.step[axis];
    }
    return grid;
}

/// Calls visit(point, square) for the points of the grid about a place, at least all nearer than `reach`, with the squares of their
/// distances from it, m2.
template <typename Visit>
void around(const Grid& grid, const Vec3& place, double reach, const Visit& visit) {
    std::array<std::vector<std::size_t>, 3> index;
    std::array<std::vector<double>, 3> square;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<Eigen::Index>(axis);
        const auto first = static_cast<std::int64_t>(std::ceil((place[a] - reach - grid.origin[a]) / grid.step[a]));
        const auto last = static_cast<std::int64_t>(std::floor((place[a] + reach - grid.origin[a]) / grid.step[a]));
        for (std::int64_t point = first; point <= last; ++point) {
            const auto at = static_cast<double>(point);
            const double wrapped = grid.periodic[axis] ? at - std::floor(at / grid.points[axis]) * grid.points[axis] : at;
            if (wrapped < 0.0 || wrapped >= grid.points[axis]) continue;
            const double offset = grid.origin[a] + at * grid.step[a] - place[a];
            index[axis].push_back(static_cast<std::size_t>(wrapped));
            square[axis].push_back(offset * offset);
        }
    }
    for (std::size_t x = 0; x < index[0].size(); ++x)
        for (std::size_t y = 0; y < index[1].size(); ++y) {
            const double before = square[0][x] + square[1][y];
            if (before > reach * reach) continue;
            const std::size_t row =
                (index[0][x] * static_cast<std::size_t>(grid.points[1]) + index[1][y]) * static_cast<std::size_t>(grid.points[2]);
            for (std::size_t z = 0; z < index[2].size(); ++z) visit(row + index[2][z], before + square[2][z]);
        }
}

/// Distance from each point to the surface of the nearest particle, m, as far as `far`.
std::vector<float> distances(const State& state, const Grid& grid, double far) {
    std::vector<float> distance(grid.size(), static_cast<float>(far));
    for (std::size_t row = 0; row < state.particles.size(); ++row) {
        const double radius = state.particles.radius[row];
        around(grid, state.particles.position[row], radius + far, [&](std::size_t point, double square) {
            distance[point] = std::min(distance[point], static_cast<float>(std::sqrt(square) - radius));
        });
    }
    return distance;
}

/// The points that hold the centre of a ball which came from a free face.
std::vector<char> reached_from_outside(const Grid& grid, const std::vector<float>& distance, double probe) {
    std::vector<char> reached(grid.size(), 0);
    std::vector<std::size_t> waiting;
    const auto enter = [&](std::size_t point) {
        if (reached[point] || distance[point] < static_cast<float>(probe)) return;
        reached[point] = 1;
        waiting.push_back(point);
    };
    for (std::size_t point = 0; point < grid.size(); ++point) {
        const Index index = grid.index_of(point);
        for (std::size_t axis = 0; axis < 3; ++axis)
            if (!grid.periodic[axis] && (index[axis] == 0 || index[axis] == grid.points[axis] - 1)) enter(point);
    }
    while (!waiting.empty()) {
        const Index index = grid.index_of(waiting.back());
        waiting.pop_back();
        for (std::size_t axis = 0; axis < 3; ++axis)
            for (const int step : {-1, 1}) {
                Index next = index;
                next[axis] += step;
                if (grid.inside(next)) enter(grid.at(next));
            }
    }
    return reached;
}

/// Square of the distance (m2) of each point from the farthest places that the ball's centre reaches, where its distance from the
/// body becomes `probe` between two points; larger than `far` squared where there is none as near.
std::vector<float> squares_from_front(const Grid& grid, const std::vector<float>& distance, const std::vector<char>& reached,
                                      double probe, double far) {
    std::vector<float> squares(grid.size(), static_cast<float>(4.0 * far * far));
    for (std::size_t point = 0; point < grid.size(); ++point) {
        if (!reached[point]) continue;
        const Index index = grid.index_of(point);
        for (int axis = 0; axis < 3; ++axis)
            for (const int step : {-1, 1}) {
                Index next = index;
                next[static_cast<std::size_t>(axis)] += step;
                if (!grid.inside(next) || reached[grid.at(next)]) continue;
                const double here = distance[point], there = distance[grid.at(next)];
                const double share = here > there ? std::clamp((here - probe) / (here - there), 0.0, 1.0) : 0.0;
                Vec3 place = grid.origin + grid.step.cwiseProduct(Vec3(index[0], index[1], index[2]));
                place[axis] += step * share * grid.step[axis];
                around(grid, place, far, [&](std::size_t near, double square) {
                    squares[near] = std::min(squares[near], static_cast<float>(square));
                });
            }
    }
    return squares;
}

}  // namespace

double envelope_volume(const State& state, double probe) {
    const Particles& particles = state.particles;
    const auto count = static_cast<double>(particles.size());
    const double diameter = 2.0 * std::accumulate(particles.radius.begin(), particles.radius.end(), 0.0) / count;
    const double spacing = std::min(diameter, probe) / (particles.size() < few_particles ? 12.0 : 6.0);
    const Grid grid = grid_for(state, probe, spacing);
    const std::vector<float> distance = distances(state, grid, probe + 2.0 * spacing);
    const std::vector<char> reached = reached_from_outside(grid, distance, probe);
    const std::vector<float> squares = squares_from_front(grid, distance, reached, probe, probe + spacing);
    double points = 0.0;  // in the envelope; those on its surface count by the share of their cell
    for (std::size_t point = 0; point < grid.size(); ++point)
        if (!reached[point])
            points += std::clamp((std::sqrt(static_cast<double>(squares[point])) - probe) / spacing + 0.5, 0.0, 1.0);
    return points * grid.step.prod();
}

}  // namespace kiln::analysis
