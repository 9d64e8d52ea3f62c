// contact_network.cpp: cutting the contacts into chunks, by which of their particles each one owns.
#include "sintering/contact_network.h"

#include <algorithm>
#include <array>
#include <utility>

namespace kiln::sintering {

namespace {

constexpr std::size_t max_pieces = 32;

enum Kind : std::size_t { both_own, first_own, second_own, through_face };

bool is_shifted(const Image& image) { return image[0] != 0 || image[1] != 0 || image[2] != 0; }

}  // namespace

ContactNetwork::ContactNetwork(const Box& box, std::span<const Vec3> position, std::span<const Pair> pairs)
    : position_(position.begin(), position.end()), entry_(pairs.size()) {
    const std::size_t count = (position.size() + chunk_particles - 1) / chunk_particles;
    const std::size_t pieces = pairs.size() < worth_threads ? 1 : max_pieces;  // of the pairs, each of which is gone through by one
    // Of each piece, chunk and kind: the number of entries, then the place of the next one.
    std::vector<std::array<std::size_t, 4>> next(pieces * count, {0, 0, 0, 0});
    const auto for_entries = [&](const auto& visit) {
        kiln::for_chunks(pieces, [&](std::size_t piece) {
            const std::size_t last = pairs.size() * (piece + 1) / pieces;
            for (std::size_t row = pairs.size() * piece / pieces; row < last; ++row) {
                const std::size_t a = static_cast<std::size_t>(pairs[row].i) / chunk_particles;
                const std::size_t b = static_cast<std::size_t>(pairs[row].j) / chunk_particles;
                const bool shifted = is_shifted(pairs[row].image);
                if (a != b) visit(row, b, next[piece * count + b][shifted ? through_face : second_own]);
                visit(row, a, next[piece * count + a][shifted ? through_face : a == b ? both_own : first_own]);
            }
        });
    };
    for_entries([&](std::size_t, std::size_t, std::size_t& entries) { ++entries; });
    std::size_t total = 0, shifts = 0;
    for (std::size_t index = 0; index < count; ++index) {
        std::array<std::size_t, 5> begin{total};
        for (std::size_t kind = 0; kind < 4; ++kind) {
            for (std::size_t piece = 0; piece < pieces; ++piece) total += std::exchange(next[piece * count + index][kind], total);
            begin[kind + 1] = total;
        }
        chunks_.push_back({.first_particle = index * chunk_particles,
                           .last_particle = std::min(position.size(), (index + 1) * chunk_particles),
                           .begin = begin[both_own],
                           .first_only = begin[first_own],
                           .second_only = begin[second_own],
                           .crossing = begin[through_face],
                           .end = total,
                           .shift_begin = shifts});
        shifts += total - begin[through_face];
    }
    for (auto* column : {&first, &second, &pair}) column->resize(total);
    shift_.resize(shifts);
    side_.resize(shifts);
    for_entries([&](std::size_t row, std::size_t index, std::size_t& place) {
        const std::size_t entry = place++;
        pair[entry] = static_cast<std::int32_t>(row);
        entry_[row] = static_cast<std::int32_t>(entry);
        first[entry] = pairs[row].i;
        second[entry] = pairs[row].j;
        const Chunk& chunk = chunks_[index];
        if (entry < chunk.crossing) return;
        const std::size_t slot = chunk.shift_begin + entry - chunk.crossing;
        const auto owner = [&](std::int32_t particle) { return static_cast<std::size_t>(particle) / chunk_particles == index; };
        shift_[slot] = box.shift(pairs[row].image);
        side_[slot] = static_cast<std::uint8_t>((owner(pairs[row].i) ? own_first : 0) | (owner(pairs[row].j) ? own_second : 0));
    });
}

}  // namespace kiln::sintering
