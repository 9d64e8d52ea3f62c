// monotone_curve.h: a smooth curve through points that makes no peaks of its own between them.
#pragma once

#include <vector>

namespace kiln::analysis {

/// Monotone cubic between points (F. N. Fritsch & J. Butland, SIAM J. Sci. Stat. Comput. 5 (1984) 300). Outside of the points it
/// keeps the value of the nearer end.
class MonotoneCurve {
   public:
    /// x ascending, at least one point; of points with the same x the last one counts.
    MonotoneCurve(const std::vector<double>& x, const std::vector<double>& y);

    /// NaN at NaN.
    double at(double x) const;

   private:
    std::vector<double> x_, y_, slope_;
};

}  // namespace kiln::analysis
