// die.cpp: what is held and what is let go.
#include "sintering/die.h"

#include <algorithm>
#include <cmath>

namespace kiln::sintering {

namespace {

constexpr double touching = 1e-12;      // step strain: the rounding of the body's strain
constexpr double visible_pull = 1e-2;   // of the largest stress, that is more than the error of a step

}  // namespace

Vec3 die_gap(const Vec3& strain) {
    Vec3 gap;
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
        const double open = std::expm1(-strain[axis]);
        gap[axis] = open > touching ? open : 0.0;
    }
    return gap;
}

Die::Die(const Axes& confined, const Axes& percolates, const Vec3& gap) : confined_(confined), gap_(gap) {
    for (std::size_t axis = 0; axis < 3; ++axis)
        held_[axis] = confined[axis] && percolates[axis] && gap[static_cast<Eigen::Index>(axis)] == 0.0;
}

Vec3 Die::strain() const {
    Vec3 strain = Vec3::Zero();
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (held_[axis]) strain[static_cast<Eigen::Index>(axis)] = gap_[static_cast<Eigen::Index>(axis)];
    return strain;
}

bool Die::revise(const Vec3& strain, const Vec3& stress) {
    bool changed = false;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto k = static_cast<Eigen::Index>(axis);
        if (!confined_[axis]) continue;
        if (held_[axis] && !released_[axis] && stress[k] > 0.0) {
            held_[axis] = false;
            released_[axis] = changed = true;
        } else if (!held_[axis] && strain[k] > gap_[k] + touching) {
            held_[axis] = changed = true;
        }
    }
    return changed;
}

bool Die::pulls(const Vec3& stress) const {
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (held_[axis] && stress[static_cast<Eigen::Index>(axis)] > visible_pull * stress.cwiseAbs().maxCoeff()) return true;
    return false;
}

void Die::confine(Vec3& strain) const {
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (confined_[axis]) strain[static_cast<Eigen::Index>(axis)] = std::min(strain[static_cast<Eigen::Index>(axis)],
                                                                               gap_[static_cast<Eigen::Index>(axis)]);
}

}  // namespace kiln::sintering
