// specimen.cpp: cutting a bar out of a periodic box.
#include "bending/specimen.h"

#include <algorithm>
#include <cmath>

#include "physics/materials.h"

namespace kiln::bending {

namespace {

using Cell = std::array<std::int64_t, 3>;

/// Number of boxes that a position was moved by, to be inside. Any number: positions may be far away where images of bonds, which
/// are differences, fit into their bytes.
Cell cell_of(const Box& box, const Vec3& position, const Vec3& inside) {
    Cell cell{0, 0, 0};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto k = static_cast<Eigen::Index>(axis);
        cell[axis] = std::llround((position[k] - inside[k]) / box.lengths[k]);
    }
    return cell;
}

/// Material of most particles.
const Material& main_material(const State& state) {
    std::vector<std::size_t> count(state.materials.size(), 0);
    for (const std::int32_t material : state.particles.material) ++count[static_cast<std::size_t>(material)];
    return state.materials[static_cast<std::size_t>(std::max_element(count.begin(), count.end()) - count.begin())];
}

}  // namespace

std::size_t cut_open(State& state) {
    std::vector<Cell> cell;
    for (Vec3& position : state.particles.position) {
        const Vec3 inside = state.box.wrap(position);
        cell.push_back(cell_of(state.box, position, inside));
        position = inside;
    }
    std::vector<std::int32_t> kept;
    Bonds& bonds = *state.bonds;
    for (std::size_t bond = 0; bond < bonds.size(); ++bond) {
        const Cell& first = cell[static_cast<std::size_t>(bonds.pair[bond][0])];
        const Cell& second = cell[static_cast<std::size_t>(bonds.pair[bond][1])];
        bool inside = true;
        for (std::size_t axis = 0; axis < 3; ++axis) inside = inside && bonds.image[bond][axis] + second[axis] == first[axis];
        if (!inside) continue;
        bonds.image[bond] = {0, 0, 0};
        kept.push_back(static_cast<std::int32_t>(bond));
    }
    const std::size_t dropped = bonds.size() - kept.size();
    bonds = take_rows(bonds, kept);
    state.box.periodic = {false, false, false};
    return dropped;
}

Specimen cut_specimen(State state, const mechanics::BondModel& model) {
    if (!state.bonds || state.bonds->size() == 0) throw Error("the state has no bonds; run bondify first");
    Specimen specimen;
    specimen.relative_density = kiln::relative_density(state);
    const Box box = state.box;
    specimen.dropped_bonds = cut_open(state);
    if (state.bonds->size() == 0) throw Error("all bonds of the state go through faces of the box, so no bar can be cut from it");
    specimen.body = mechanics::bonded_body(state, model);
    specimen.origin = box.origin;
    specimen.size = box.lengths;
    for (int axis = 0; axis < 3; ++axis) {
        if (box.periodic[static_cast<std::size_t>(axis)]) continue;
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (const auto& pair : state.bonds->pair) {
            for (const std::int32_t row : pair) {
                const auto particle = static_cast<std::size_t>(row);
                low = std::min(low, state.particles.position[particle][axis] - state.particles.radius[particle]);
                high = std::max(high, state.particles.position[particle][axis] + state.particles.radius[particle]);
            }
        }
        specimen.origin[axis] = low;
        specimen.size[axis] = high - low;
    }
    const Material& material = main_material(state);
    specimen.young_modulus = physics::required(material.young_modulus, material, "young_modulus");
    specimen.poisson_ratio = physics::required(material.poisson_ratio, material, "poisson_ratio");
    specimen.solid = material.name;
    specimen.state = std::move(state);
    return specimen;
}

}  // namespace kiln::bending
