// spatial_order_test.cpp: Morton's curve through cells.
#include "core/spatial_order.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <numeric>
#include <random>

using namespace kiln;

namespace {

/// Middles of the eight unit cells of a box of edge 2, in a given order of x, y, z digits.
std::vector<Vec3> eight_cells(const std::vector<int>& cells) {
    std::vector<Vec3> position;
    for (const int cell : cells) position.push_back(Vec3(cell & 1, cell >> 1 & 1, cell >> 2 & 1) + Vec3::Constant(0.5));
    return position;
}

Box box_of(double edge) {
    Box box;
    box.lengths = Vec3::Constant(edge);
    return box;
}

}  // namespace

TEST_CASE("spatial order: eight cells are passed in the order of their numbers, x fastest") {
    const std::vector<int> cells{5, 0, 7, 2, 6, 3, 1, 4};
    const std::vector<std::int32_t> order = spatial_order(box_of(2.0), eight_cells(cells), 1.0);
    for (std::size_t place = 0; place < 8; ++place) CHECK(cells[static_cast<std::size_t>(order[place])] == static_cast<int>(place));
}

TEST_CASE("spatial order: rows of one cell keep their order, images of a particle share its cell") {
    const std::vector<Vec3> position{{1.5, 0.5, 0.5}, {0.1, 0.1, 0.1}, {0.9, 0.9, 0.9}, {3.7, -3.6, 8.4}, {2.2, -1.9, 4.3}};
    // The fourth is 1.7, 0.4, 0.4 and the last 0.2, 0.1, 0.3 in the box.
    CHECK(spatial_order(box_of(2.0), position, 1.0) == std::vector<std::int32_t>{1, 2, 4, 0, 3});
}

TEST_CASE("spatial order: where faces are free, cells count from the foremost particle") {
    Box box = box_of(2.0);
    box.periodic = {false, false, false};
    const std::vector<Vec3> position{{0.5, 0.5, 0.5}, {-1.5, 0.5, 0.5}, {-0.6, 0.5, 0.5}};
    CHECK(spatial_order(box, position, 1.0) == std::vector<std::int32_t>{1, 2, 0});
}

TEST_CASE("spatial order: a permutation in which neighbours in the list are near each other") {
    std::mt19937_64 bits(5);
    std::vector<Vec3> position;
    for (int row = 0; row < 4096; ++row) {
        Vec3 place;
        for (double& component : place) component = static_cast<double>(bits() >> 11) * 0x1p-53;
        position.push_back(place);
    }
    std::vector<std::int32_t> order = spatial_order(box_of(1.0), position, 1.0 / 1024.0);
    double way = 0.0;
    for (std::size_t place = 1; place < order.size(); ++place)
        way += (position[static_cast<std::size_t>(order[place])] - position[static_cast<std::size_t>(order[place - 1])]).norm();
    // Points lie 1/16 apart; at random the mean way would be 0.66.
    CHECK(way / 4095.0 < 2.0 / 16.0);
    std::sort(order.begin(), order.end());
    std::vector<std::int32_t> rows(4096);
    std::iota(rows.begin(), rows.end(), 0);
    CHECK(order == rows);
}

TEST_CASE("spatial order: coordinates beyond the last cell do not wrap around to the first") {
    Box box = box_of(1.0);
    box.periodic = {false, false, false};
    const std::vector<Vec3> position{{1e7, 0.0, 0.0}, {0.5, 0.0, 0.0}, {3e6, 0.0, 0.0}, {2e9, 0.0, 0.0}};
    const std::vector<std::int32_t> order = spatial_order(box, position, 1.0);
    CHECK(order.front() == 1);
}
