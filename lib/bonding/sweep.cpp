// sweep.cpp: the shrinking of overlapping spheres by finite decrements, Eq. 2-3 of Dosta et al. 2017 as they stand.
#include "bonding/sweep.h"

#include <algorithm>
#include <numbers>

namespace kiln::bonding {

namespace {

/// One sweep's step of every particle; given[i] is what each overlap of particle i gets from it, m3.
void step(std::vector<double>& radius, std::span<const double> smallest, std::span<const std::int32_t> overlaps, Sharing sharing,
          double decrement, std::vector<double>& given) {
    for (std::size_t i = 0; i < radius.size(); ++i) {
        if (overlaps[i] == 0) continue;
        const double before = radius[i];
        const double after = std::max(before - (sharing == Sharing::pair ? overlaps[i] : 1) * decrement, smallest[i]);
        const double cubes = (before - after) * (before * before + before * after + after * after);
        given[i] = 4.0 / 3.0 * std::numbers::pi * cubes / overlaps[i];
        radius[i] = after;
    }
}

}  // namespace

ShrunkSpheres shrink_by_sweeps(std::span<const double> radius, std::span<const Overlap> overlaps, Sharing sharing, double decrement,
                        const Watch& watch) {
    ShrunkSpheres result{.radius{radius.begin(), radius.end()}, .volume = std::vector<double>(overlaps.size())};
    std::vector<double> smallest(radius.size()), given(radius.size());
    std::ranges::transform(radius, smallest.begin(), [](double r) { return min_share * r; });
    std::vector<std::int32_t> count(radius.size());
    std::vector<std::uint32_t> active(overlaps.size());
    for (std::uint32_t index = 0; index < overlaps.size(); ++index) {
        active[index] = index;
        ++count[static_cast<std::size_t>(overlaps[index].first)];
        ++count[static_cast<std::size_t>(overlaps[index].second)];
    }

    while (!active.empty()) {
        step(result.radius, smallest, count, sharing, decrement, given);
        std::erase_if(active, [&](std::uint32_t index) {
            const auto i = static_cast<std::size_t>(overlaps[index].first);
            const auto j = static_cast<std::size_t>(overlaps[index].second);
            result.volume[index] += given[i] + given[j];
            const bool apart = result.radius[i] + result.radius[j] <= overlaps[index].distance;
            if (apart) --count[i], --count[j];
            return apart;
        });
        watch.at(1.0 - static_cast<double>(active.size()) / static_cast<double>(overlaps.size()));
    }
    for (std::size_t i = 0; i < radius.size(); ++i) result.stopped += result.radius[i] <= smallest[i];
    return result;
}

}  // namespace kiln::bonding
