// interpolate.cpp: a state between two states of the same particles.
#include "analysis/interpolate.h"

#include <cmath>
#include <map>
#include <tuple>
#include <unordered_map>

#include "physics/sinter_contact.h"

namespace kiln::analysis {

namespace {

/// The row in `second` of each particle of `first`.
std::vector<std::size_t> matched_rows(const Particles& first, const Particles& second) {
    if (first.size() != second.size())
        throw Error("the states differ: one has " + std::to_string(first.size()) + " particles, the next " +
                    std::to_string(second.size()));
    std::unordered_map<std::int64_t, std::size_t> row_of;
    for (std::size_t row = 0; row < second.size(); ++row) row_of[second.id[row]] = row;
    std::vector<std::size_t> rows;
    for (const std::int64_t id : first.id) {
        const auto found = row_of.find(id);
        if (found == row_of.end())
            throw Error("the states differ: particle " + std::to_string(id) + " is in one and not in the next");
        rows.push_back(found->second);
    }
    return rows;
}

double between(double first, double second, double share) { return first + share * (second - first); }

void blend(std::vector<double>& first, const std::vector<double>& second, double share) {
    for (std::size_t row = 0; row < first.size(); ++row) first[row] = between(first[row], second[row], share);
}

/// first: bonds of the result, to be changed; rows: of each of its particles in the second state.
void blend_bonds(State& first, const State& second, const std::vector<std::size_t>& rows, double share) {
    if (!first.bonds && !second.bonds) return;
    if (!first.bonds || !second.bonds || first.bonds->size() != second.bonds->size())
        throw Error("the states differ: they do not have the same bonds");
    Bonds& bonds = *first.bonds;
    for (std::size_t bond = 0; bond < bonds.size(); ++bond)
        for (std::size_t end = 0; end < 2; ++end)
            if (rows[static_cast<std::size_t>(bonds.pair[bond][end])] != static_cast<std::size_t>(second.bonds->pair[bond][end]))
                throw Error("the states differ: bond " + std::to_string(bond) + " joins other particles in the next one");
    blend(bonds.radius, second.bonds->radius, share);
    blend(bonds.length, second.bonds->length, share);
    blend(bonds.volume, second.bonds->volume, share);
}

using NeckKey = std::tuple<std::int32_t, std::int32_t, Image>;  // rows of the first state, in order

NeckKey key_of(std::int32_t i, std::int32_t j, const std::array<int, 3>& boxes) {
    const bool turned = i > j || (i == j && boxes < std::array{0, 0, 0});
    Image image;
    for (std::size_t axis = 0; axis < 3; ++axis) image[axis] = static_cast<std::int8_t>(turned ? -boxes[axis] : boxes[axis]);
    return turned ? NeckKey{j, i, image} : NeckKey{i, j, image};
}

/// Neck of a pair that a state does not list, m.
double unlisted_neck(const State& state, std::size_t i, std::size_t j, const Image& image) {
    const double first = state.particles.radius[i], second = state.particles.radius[j];
    const double distance = (state.particles.position[j] + state.box.shift(image) - state.particles.position[i]).norm();
    return std::sqrt(physics::contact_radius_squared(first + second - distance, physics::reduced_radius(first, second)));
}

/// first: necks of the result, to be changed; boxes: by which each of its particles is further in it than in the second state.
void blend_necks(State& result, const State& first, const State& second, const std::vector<std::size_t>& rows,
                 const std::vector<std::array<int, 3>>& boxes, double share) {
    if (!first.necks && !second.necks) return;
    std::vector<std::int32_t> row_of(rows.size());  // in the first state
    for (std::size_t row = 0; row < rows.size(); ++row) row_of[rows[row]] = static_cast<std::int32_t>(row);
    std::map<NeckKey, std::array<double, 2>> necks;  // radii in both states, m; below zero where it is not listed
    for (std::size_t neck = 0; first.necks && neck < first.necks->size(); ++neck) {
        const auto [i, j] = first.necks->pair[neck];
        const Image& image = first.necks->image[neck];
        necks[key_of(i, j, {image[0], image[1], image[2]})] = {first.necks->radius[neck], -1.0};
    }
    for (std::size_t neck = 0; second.necks && neck < second.necks->size(); ++neck) {
        const std::int32_t i = row_of[static_cast<std::size_t>(second.necks->pair[neck][0])];
        const std::int32_t j = row_of[static_cast<std::size_t>(second.necks->pair[neck][1])];
        std::array<int, 3> image;
        for (std::size_t axis = 0; axis < 3; ++axis)
            image[axis] = second.necks->image[neck][axis] + boxes[static_cast<std::size_t>(i)][axis] -
                          boxes[static_cast<std::size_t>(j)][axis];
        necks.try_emplace(key_of(i, j, image), std::array{-1.0, -1.0}).first->second[1] = second.necks->radius[neck];
    }
    result.necks.emplace();
    for (const auto& [key, radius] : necks) {
        const auto& [i, j, image] = key;
        const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
        Image there;
        for (std::size_t axis = 0; axis < 3; ++axis)
            there[axis] = static_cast<std::int8_t>(image[axis] - boxes[a][axis] + boxes[b][axis]);
        const double here = radius[0] < 0.0 ? unlisted_neck(first, a, b, image) : radius[0];
        const double next = radius[1] < 0.0 ? unlisted_neck(second, rows[a], rows[b], there) : radius[1];
        result.necks->pair.push_back({i, j});
        result.necks->image.push_back(image);
        result.necks->radius.push_back(between(here, next, share));
    }
}

}  // namespace

State interpolated(const State& first, const State& second, double share) {
    const std::vector<std::size_t> rows = matched_rows(first.particles, second.particles);
    if (first.box.periodic != second.box.periodic) throw Error("the states differ: their boxes are periodic along different axes");
    State state = first;
    state.time = between(first.time, second.time, share);
    if (first.temperature && second.temperature) state.temperature = between(*first.temperature, *second.temperature, share);
    state.box.origin = first.box.origin + share * (second.box.origin - first.box.origin);
    state.box.lengths = first.box.lengths + share * (second.box.lengths - first.box.lengths);
    std::vector<std::array<int, 3>> boxes(rows.size());
    for (std::size_t row = 0; row < rows.size(); ++row) {
        const Vec3 here = (first.particles.position[row] - first.box.origin).cwiseQuotient(first.box.lengths);
        Vec3 step = (second.particles.position[rows[row]] - second.box.origin).cwiseQuotient(second.box.lengths) - here;
        for (int axis = 0; axis < 3; ++axis)
            if (state.box.periodic[static_cast<std::size_t>(axis)]) {
                boxes[row][static_cast<std::size_t>(axis)] = -static_cast<int>(std::round(step[axis]));
                step[axis] -= std::round(step[axis]);
            }
        state.particles.position[row] = state.box.origin + (here + share * step).cwiseProduct(state.box.lengths);
        state.particles.radius[row] = between(first.particles.radius[row], second.particles.radius[rows[row]], share);
    }
    blend_bonds(state, second, rows, share);
    blend_necks(state, first, second, rows, boxes, share);
    return state;
}

}  // namespace kiln::analysis
