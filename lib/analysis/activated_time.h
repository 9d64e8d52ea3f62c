// activated_time.h: integrals of thermally activated rates along a firing, and their inverse.
#pragma once

#include <functional>
#include <vector>

#include "physics/schedule.h"

namespace kiln::analysis {

/// Temperature along a firing, cut so finely that the logarithm of an activated rate is nearly straight from node to node.
struct FiringPath {
    std::vector<double> time;         // s
    std::vector<double> temperature;  // K

    /// From `from` to `until`, s, until > from.
    FiringPath(const physics::Schedule& schedule, double from, double until);
};

/// The integral of a rate over the time of a firing. Exact to about 1e-6 for activation energies up to 1000 kJ/mol.
class ActivatedTime {
   public:
    /// rate: of the temperature in K, positive. path must live as long as this.
    ActivatedTime(const FiringPath& path, const std::function<double(double)>& rate);

    /// Integral from the beginning of the firing up to a time, s; zero before it, the whole after it.
    double at(double time) const;

    /// The time at which the integral has a value; the end of the firing for more than the whole.
    double time_of(double integral) const;

    double whole() const { return integral_.back(); }

   private:
    const FiringPath& path_;
    std::vector<double> integral_;  // up to each node
    std::vector<double> growth_;    // of the rate's logarithm from each node to the next
};

}  // namespace kiln::analysis
