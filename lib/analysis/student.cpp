// student.cpp: quantiles of Student's t distribution, from Boost.
#include "analysis/student.h"

#include <boost/math/distributions/students_t.hpp>

namespace kiln::analysis {

double student_factor(std::size_t degrees_of_freedom, double confidence) {
    const boost::math::students_t distribution(static_cast<double>(degrees_of_freedom));
    return boost::math::quantile(distribution, 0.5 + 0.5 * confidence);
}

}  // namespace kiln::analysis
