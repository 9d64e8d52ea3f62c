// contact_network.cpp: cutting the contacts into chunks, by which of their particles each one owns.
#include "numerics/contact_network.h"

#include <array>

namespace kiln::numerics {

namespace {

constexpr std::size_t chunk_particles = 2048;  // fixed, so that sums do not depend on the number of threads

enum Kind : std::size_t { both_own, first_own, second_own, through_face };

bool is_shifted(const Image& image) { return image[0] != 0 || image[1] != 0 || image[2] != 0; }

}  // namespace

ContactNetwork::ContactNetwork(const Box& box, std::span<const Vec3> position, std::span<const Pair> pairs)
    : position_(position.begin(), position.end()) {
    const std::size_t count = (position.size() + chunk_particles - 1) / chunk_particles;
    std::vector<std::array<std::vector<std::int32_t>, 4>> lists(count);  // pairs of each chunk by kind
    for (std::size_t row = 0; row < pairs.size(); ++row) {
        const std::size_t a = static_cast<std::size_t>(pairs[row].i) / chunk_particles;
        const std::size_t b = static_cast<std::size_t>(pairs[row].j) / chunk_particles;
        const bool shifted = is_shifted(pairs[row].image);
        lists[a][shifted ? through_face : a == b ? both_own : first_own].push_back(static_cast<std::int32_t>(row));
        if (a != b) lists[b][shifted ? through_face : second_own].push_back(static_cast<std::int32_t>(row));
    }
    std::size_t total = 0;
    for (std::size_t index = 0; index < count; ++index) {
        Chunk chunk{};
        chunk.first_particle = index * chunk_particles;
        chunk.last_particle = std::min(position.size(), (index + 1) * chunk_particles);
        chunk.begin = total;
        chunk.first_only = chunk.begin + lists[index][both_own].size();
        chunk.second_only = chunk.first_only + lists[index][first_own].size();
        chunk.crossing = chunk.second_only + lists[index][second_own].size();
        chunk.end = total = chunk.crossing + lists[index][through_face].size();
        chunk.shift_begin = shift_.size();
        for (const std::int32_t row : lists[index][through_face]) {
            const Pair& each = pairs[static_cast<std::size_t>(row)];
            shift_.push_back(box.shift(each.image));
            const auto owner = [&](std::int32_t particle) { return static_cast<std::size_t>(particle) / chunk_particles == index; };
            side_.push_back(static_cast<std::uint8_t>((owner(each.i) ? own_first : 0) | (owner(each.j) ? own_second : 0)));
        }
        chunks_.push_back(chunk);
    }
    for (auto* column : {&first, &second, &pair}) column->resize(total);
    for (auto* column : {&nx, &ny, &nz, &normal, &tangential}) column->resize(total);
    for_chunks([&](std::size_t index) {
        std::size_t entry = chunks_[index].begin;
        for (const auto& list : lists[index])
            for (const std::int32_t row : list) {
                pair[entry] = row;
                first[entry] = pairs[static_cast<std::size_t>(row)].i;
                second[entry] = pairs[static_cast<std::size_t>(row)].j;
                ++entry;
            }
    });
}

}  // namespace kiln::numerics
