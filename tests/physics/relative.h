// relative.h: comparison of numbers of any size; doctest's Approx alone adds 1 to the size and so accepts any two small ones.
#pragma once

#include <doctest/doctest.h>

#include <cmath>

namespace kiln::test {

inline doctest::Approx relative(double value, double epsilon) { return doctest::Approx(value).scale(0.0).epsilon(epsilon); }

/// Relative deviation of a value from what is expected.
inline double deviation(double value, double expected) { return std::abs(value - expected) / std::abs(expected); }

}  // namespace kiln::test
