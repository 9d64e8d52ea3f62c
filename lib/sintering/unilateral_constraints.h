// unilateral_constraints.h: pairs that may close only so far, rigid particles that meet and necks at the dihedral limit.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace kiln::sintering {

/// Unilateral constraints w <= limit on the approach w of pairs, by augmented Lagrangian: the reaction max(0, lambda + s (w -
/// limit)) of a spring s with a multiplier lambda that takes over the reaction, so that the limit is met exactly with a spring of
/// ordinary stiffness. Source: Nocedal & Wright, Numerical Optimization, 2006, section 17.4.
class UnilateralConstraints {
   public:
    /// Forgets all; `pairs` rows without a limit.
    void reset(std::size_t pairs) {
        limit_.assign(pairs, no_limit);
        multiplier_.assign(pairs, 0.0);
        stiffness_.assign(pairs, 0.0);
        rows_.clear();
    }

    /// Limits a row by a spring of that stiffness; expected: the reaction to begin with.
    void add(std::size_t row, double limit, double expected, double stiffness) {
        rows_.push_back(row);
        limit_[row] = limit;
        multiplier_[row] = expected;
        stiffness_[row] = stiffness;
    }

    bool any() const { return !rows_.empty(); }

    /// True where the limit carried a force at the last update.
    bool holds(std::size_t row) const { return multiplier_[row] > 0.0; }

    /// Stiffness against further approach under a force that nothing but the limit holds: beyond the limit the spring's. Before it
    /// the secant towards where the spring would hold that force: with none there, Newton would leap into the spring and back.
    double tangent(std::size_t row, double approach, double force) const {
        if (std::isinf(limit_[row])) return 0.0;
        if (reaction(row, approach) > 0.0) return stiffness_[row];
        const double held = limit_[row] + (force - multiplier_[row]) / stiffness_[row];
        return held > approach ? force / (held - approach) : 0.0;
    }

    double reaction(std::size_t row, double approach) const {
        return std::isinf(limit_[row]) ? 0.0 : std::max(0.0, multiplier_[row] + stiffness_[row] * (approach - limit_[row]));
    }

    /// Moves the reactions into the multipliers; approach(row) is that of the present motion. Returns by how much the worst of the
    /// limits is missed, over tolerance(row).
    template <typename Closing, typename Tolerance>
    double update(const Closing& approach, const Tolerance& tolerance) {
        double worst = 0.0;
        for (const std::size_t row : rows_) {
            const double w = approach(row), next = reaction(row, w);
            // Beyond the limit, or held back before it by a multiplier that is still too large.
            const double missed = next > 0.0 ? std::abs(w - limit_[row]) : std::max(0.0, w - limit_[row]);
            worst = std::max(worst, missed / tolerance(row));
            multiplier_[row] = next;
        }
        return worst;
    }

    static constexpr double no_limit = HUGE_VAL;

   private:
    std::vector<double> limit_, multiplier_, stiffness_;  // a row a pair
    std::vector<std::size_t> rows_;                       // those with a limit
};

}  // namespace kiln::sintering
