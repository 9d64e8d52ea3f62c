// size_classes.h: size distributions as laboratories measure them, in classes, by number or by volume; drawing by number from them.
#pragma once

#include <vector>

#include "packing/random.h"

namespace kiln::packing {

/// What shares of a distribution count: particles, or their volume (of one material the same as mass).
enum class Weighting { number, volume };

/// Whether a length, m, is one that a particle may have: from 1e-15 to 1e6.
bool is_diameter(double diameter);

/// Particles between two diameters, or of one where both are equal.
struct SizeClass {
    double lower, upper;  // m
    double share;         // of what the weighting says
};

/// A point of a cumulative distribution.
struct Undersize {
    double diameter;  // m
    double below;     // share of what is smaller
};

/// A measured distribution. Inside a class the share is spread evenly over the logarithm of the diameter, as a straight line
/// between two points of a cumulative curve over a logarithmic axis says.
class SizeClasses {
   public:
    /// Classes in ascending order that do not overlap, of any common measure of their shares. Throws Error for diameters that are
    /// not positive or not ascending, for negative shares, or where all are zero.
    SizeClasses(const std::vector<SizeClass>& measured, Weighting weighting);

    /// So many diameters (m), ascending: one from each of equal parts of the number distribution, so that each class has its share
    /// to within one or two particles.
    std::vector<double> draw(std::size_t particles, Random& random) const;

    /// The diameter (m) below which a fraction lies, by number or volume, whatever the distribution was measured by.
    double quantile(double fraction, Weighting weighting) const;

    /// Mean diameter by number, m.
    double mean() const;

   private:
    std::vector<SizeClass> classes_;  // shares of the number of particles, of sum 1
    int power_;  // inside a class the number of particles over the logarithm of the diameter goes as its power -power_
};

/// Classes between the points of a cumulative distribution whose diameters and shares ascend. What lies below the first point, or
/// above the last, has the diameter of that point.
std::vector<SizeClass> classes_between(const std::vector<Undersize>& points);

/// The cumulative distribution with the given D10, D50 and D90 that is lognormal on either side of D50, cut off at `smallest` and
/// `largest`, m: a tenth lies between smallest and D10, and a tenth between D90 and largest. The diameters ascend.
std::vector<Undersize> through_percentiles(double d10, double d50, double d90, double smallest, double largest);

}  // namespace kiln::packing
