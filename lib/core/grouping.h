// grouping.h: items sorted by a key, the one counting sort.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace kiln {

/// Items in the order of their keys; those of one key in the order they came in.
template <typename Item>
struct Grouping {
    std::vector<std::size_t> begin{0};  // of each key's items, and the end of the last
    std::vector<Item> items;

    std::span<const Item> of(std::size_t key) const { return {items.data() + begin[key], begin[key + 1] - begin[key]}; }
};

/// Groups what `for_each` visits: it calls visit(key, item) for each item, with keys below `keys`, and is called twice.
template <typename Item, typename ForEach>
Grouping<Item> group_by(std::size_t keys, const ForEach& for_each) {
    Grouping<Item> groups;
    groups.begin.assign(keys + 1, 0);
    for_each([&](std::size_t key, const Item&) { ++groups.begin[key + 1]; });
    for (std::size_t key = 0; key < keys; ++key) groups.begin[key + 1] += groups.begin[key];
    groups.items.resize(groups.begin.back());
    std::vector<std::size_t> next(groups.begin.begin(), groups.begin.end() - 1);
    for_each([&](std::size_t key, const Item& item) { groups.items[next[key]++] = item; });
    return groups;
}

}  // namespace kiln
