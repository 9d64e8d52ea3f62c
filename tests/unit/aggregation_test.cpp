// aggregation_test.cpp: aggregates cover every node once, whatever the order of the nodes.
#include "linalg/aggregation.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <numeric>
#include <random>

using namespace kiln;
using namespace kiln::linalg;

namespace {

constexpr int edge = 14;

/// A cubic lattice of equal springs whose nodes have these numbers, and two nodes more that only each other hold.
Springs<double> lattice(const std::vector<std::int32_t>& number) {
    std::vector<Spring<double>> springs;
    const auto connect = [&](int a, int b) {
        springs.push_back({number[static_cast<std::size_t>(a)], number[static_cast<std::size_t>(b)], {0.5, 0.0, 0.0}, 1, 1, 1, 1});
    };
    for (int site = 0; site < edge * edge * edge; ++site) {
        if (site % edge + 1 < edge) connect(site, site + 1);
        if (site / edge % edge + 1 < edge) connect(site, site + edge);
        if (site / (edge * edge) + 1 < edge) connect(site, site + edge * edge);
    }
    connect(edge * edge * edge, edge * edge * edge + 1);
    return {number.size(), springs};
}

}  // namespace

TEST_CASE("aggregates cover every node once, each in the reach of its root, and stand in the order of their roots") {
    std::vector<std::int32_t> number(edge * edge * edge + 2);
    std::iota(number.begin(), number.end(), 0);
    std::size_t count[2];
    for (const bool shuffled : {false, true}) {
        if (shuffled) std::shuffle(number.begin(), number.end(), std::mt19937(3));
        const Couplings couplings = couplings_of(lattice(number));
        for (const int rings : {1, 2}) {
            CAPTURE(rings);
            const Aggregates aggregates = find_aggregates(couplings, rings);
            REQUIRE(aggregates.of.size() == number.size());
            CHECK(std::ranges::is_sorted(aggregates.root));
            for (std::size_t k = 0; k < aggregates.root.size(); ++k) {
                const auto self = static_cast<std::int32_t>(k);
                CHECK(aggregates.of[static_cast<std::size_t>(aggregates.root[k])] == self);
                // Nodes that are reached from the root within the aggregate, one bond further each time.
                std::vector<bool> reached(number.size(), false);
                reached[static_cast<std::size_t>(aggregates.root[k])] = true;
                for (int bond = 0; bond <= rings; ++bond) {
                    const std::vector<bool> before = reached;
                    for (std::size_t node = 0; node < number.size(); ++node)
                        for (const Coupling& neighbour : couplings.of(node))
                            if (before[static_cast<std::size_t>(neighbour.node)] && aggregates.of[node] == self)
                                reached[node] = true;
                }
                CHECK(std::ranges::count(aggregates.of, self) == std::ranges::count(reached, true));
            }
            CHECK(std::ranges::min(aggregates.of) == 0);
            CHECK(std::ranges::max(aggregates.of) + 1 == std::ssize(aggregates.root));
            if (rings == 2) count[shuffled ? 1 : 0] = aggregates.root.size();
        }
    }
    // A front starts elsewhere, and packs them as closely.
    CHECK(10 * count[1] > 9 * count[0]);
    CHECK(10 * count[1] < 11 * count[0]);
}
