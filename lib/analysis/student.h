// student.h: the width of an interval of confidence from few points.
#pragma once

#include <cstddef>

namespace kiln::analysis {

/// Factor t by which a standard error is multiplied for a two-sided interval that holds the true value in a share `confidence` of
/// all cases (Student's t distribution). degrees_of_freedom > 0, 0 < confidence < 1.
double student_factor(std::size_t degrees_of_freedom, double confidence);

}  // namespace kiln::analysis
