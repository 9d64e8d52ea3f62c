// contact_network.cpp: cutting the contacts into chunks, by which of their particles each one owns.
#include "sintering/contact_network.h"

#include <array>

namespace kiln::sintering {

namespace {

enum Kind : std::size_t { both_own, first_own, second_own, through_face };

bool is_shifted(const Image& image) { return image[0] != 0 || image[1] != 0 || image[2] != 0; }

}  // namespace

ContactNetwork::ContactNetwork(const Box& box, std::span<const Vec3> position, std::span<const Pair> pairs)
    : position_(position.begin(), position.end()) {
    const std::size_t count = (position.size() + chunk_particles - 1) / chunk_particles;
    // Of each chunk and kind: the number of entries, then the place of the next one.
    std::vector<std::array<std::size_t, 4>> next(count, {0, 0, 0, 0});
    const auto for_entries = [&](const auto& visit) {
        for (std::size_t row = 0; row < pairs.size(); ++row) {
            const std::size_t a = static_cast<std::size_t>(pairs[row].i) / chunk_particles;
            const std::size_t b = static_cast<std::size_t>(pairs[row].j) / chunk_particles;
            const bool shifted = is_shifted(pairs[row].image);
            visit(row, a, shifted ? through_face : a == b ? both_own : first_own);
            if (a != b) visit(row, b, shifted ? through_face : second_own);
        }
    };
    for_entries([&](std::size_t, std::size_t chunk, Kind kind) { ++next[chunk][kind]; });
    std::size_t total = 0, shifts = 0;
    for (std::size_t index = 0; index < count; ++index) {
        Chunk chunk{};
        chunk.first_particle = index * chunk_particles;
        chunk.last_particle = std::min(position.size(), (index + 1) * chunk_particles);
        chunk.begin = total;
        chunk.first_only = chunk.begin + next[index][both_own];
        chunk.second_only = chunk.first_only + next[index][first_own];
        chunk.crossing = chunk.second_only + next[index][second_own];
        chunk.end = total = chunk.crossing + next[index][through_face];
        chunk.shift_begin = shifts;
        shifts += next[index][through_face];
        next[index] = {chunk.begin, chunk.first_only, chunk.second_only, chunk.crossing};
        chunks_.push_back(chunk);
    }
    for (auto* column : {&first, &second, &pair}) column->resize(total);
    shift_.resize(shifts);
    side_.resize(shifts);
    for_entries([&](std::size_t row, std::size_t index, Kind kind) {
        const std::size_t entry = next[index][kind]++;
        pair[entry] = static_cast<std::int32_t>(row);
        first[entry] = pairs[row].i;
        second[entry] = pairs[row].j;
        if (kind != through_face) return;
        const std::size_t slot = chunks_[index].shift_begin + entry - chunks_[index].crossing;
        const auto owner = [&](std::int32_t particle) { return static_cast<std::size_t>(particle) / chunk_particles == index; };
        shift_[slot] = box.shift(pairs[row].image);
        side_[slot] = static_cast<std::uint8_t>((owner(pairs[row].i) ? own_first : 0) | (owner(pairs[row].j) ? own_second : 0));
    });
}

}  // namespace kiln::sintering
