// die.h: faces of the box that hold but do not pull, as those of a die do: which of them the body presses on in a step.
#pragma once

#include <array>

#include "core/state.h"

namespace kiln::sintering {

using Axes = std::array<bool, 3>;

/// Step strains up to which a die lets the body grow along each axis until it is met: zero where it is touched. strain: of the
/// body since it filled the die, logarithmic.
Vec3 die_gap(const Vec3& strain);

/// The active set of one step: along each confined axis either the wall holds the body and its stress is compressive, or the body
/// is clear of it and there is no stress (the conditions of Karush, Kuhn and Tucker of the step's convex function under
/// strain <= gap). Source: Nocedal & Wright, Numerical Optimization, 2006, section 16.5.
class Die {
   public:
    /// Begins with the walls that are touched along axes that contacts reach through; only there can a wall pull or press.
    Die(const Axes& confined, const Axes& percolates, const Vec3& gap);

    const Axes& held() const { return held_; }

    /// Strain of the step along the axes that are held, zero along the others.
    Vec3 strain() const;

    /// Lets go where the wall would pull, takes hold where the body would pass it; stress: tension positive, in any unit. Returns
    /// true if that changed what is held. A wall lets go once in a step at most, so this ends.
    bool revise(const Vec3& strain, const Vec3& stress);

    /// True if a wall that is held pulls by more than the solver's error, after revise() changes nothing any more.
    bool pulls(const Vec3& stress) const;

    /// Takes from a strain what passes a wall.
    void confine(Vec3& strain) const;

   private:
    Axes confined_, held_{false, false, false}, released_{false, false, false};
    Vec3 gap_;
};

}  // namespace kiln::sintering
