// interpolate.cpp: a state between two states of the same particles.
#include "analysis/interpolate.h"

#include <cmath>
#include <unordered_map>

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

}  // namespace

State interpolated(const State& first, const State& second, double share) {
    const std::vector<std::size_t> rows = matched_rows(first.particles, second.particles);
    if (first.box.periodic != second.box.periodic) throw Error("the states differ: their boxes are periodic along different axes");
    State state = first;
    state.time = between(first.time, second.time, share);
    if (first.temperature && second.temperature) state.temperature = between(*first.temperature, *second.temperature, share);
    state.box.origin = first.box.origin + share * (second.box.origin - first.box.origin);
    state.box.lengths = first.box.lengths + share * (second.box.lengths - first.box.lengths);
    for (std::size_t row = 0; row < rows.size(); ++row) {
        const Vec3 here = (first.particles.position[row] - first.box.origin).cwiseQuotient(first.box.lengths);
        Vec3 step = (second.particles.position[rows[row]] - second.box.origin).cwiseQuotient(second.box.lengths) - here;
        for (int axis = 0; axis < 3; ++axis)
            if (state.box.periodic[static_cast<std::size_t>(axis)]) step[axis] -= std::round(step[axis]);
        state.particles.position[row] = state.box.origin + (here + share * step).cwiseProduct(state.box.lengths);
        state.particles.radius[row] = between(first.particles.radius[row], second.particles.radius[rows[row]], share);
    }
    blend_bonds(state, second, rows, share);
    return state;
}

}  // namespace kiln::analysis
