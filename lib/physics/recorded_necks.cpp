// recorded_necks.cpp: joins two sorted lists of pairs.
#include "physics/recorded_necks.h"

#include <cmath>
#include <numeric>

#include "physics/sinter_contact.h"

namespace kiln::physics {

namespace {

/// A pair seen from the particle, or the image, that find_pairs takes for the first.
Pair in_order(const std::array<std::int32_t, 2>& rows, Image image) {
    const bool turned = rows[0] > rows[1] || (rows[0] == rows[1] && image < Image{0, 0, 0});
    if (!turned) return {rows[0], rows[1], image};
    for (std::int8_t& boxes : image) boxes = static_cast<std::int8_t>(-boxes);
    return {rows[1], rows[0], image};
}

}  // namespace

RecordedContacts recorded_contacts(const State& state) {
    const std::vector<double>& radius = state.particles.radius;
    const std::vector<Pair> found = find_pairs(state.box, state.particles.position, radius);
    std::vector<std::pair<Pair, double>> record;
    for (std::size_t row = 0; state.necks && row < state.necks->size(); ++row)
        record.emplace_back(in_order(state.necks->pair[row], state.necks->image[row]), state.necks->radius[row]);
    std::ranges::sort(record, {}, &std::pair<Pair, double>::first);

    RecordedContacts contacts;
    const auto add = [&](const Pair& pair, const double* neck) {
        const double first = radius[static_cast<std::size_t>(pair.i)], second = radius[static_cast<std::size_t>(pair.j)];
        const double reduced = reduced_radius(first, second);
        const double overlap = neck ? overlap_of_neck(*neck, reduced)
                                    : first + second - pair_vector(state.box, state.particles.position, pair).norm();
        contacts.pairs.push_back(pair);
        contacts.overlap.push_back(overlap);
        contacts.neck.push_back(neck ? *neck : std::sqrt(contact_radius_squared(overlap, reduced)));
        contacts.recorded.push_back(neck != nullptr);
    };
    auto neck = record.begin();
    const auto add_record = [&] {
        if (neck->second > 0.0) add(neck->first, &neck->second);
        ++neck;
    };
    for (const Pair& pair : found) {
        while (neck != record.end() && neck->first < pair) add_record();
        if (neck != record.end() && neck->first == pair)
            add_record();
        else
            add(pair, nullptr);
    }
    while (neck != record.end()) add_record();
    return contacts;
}

}  // namespace kiln::physics
