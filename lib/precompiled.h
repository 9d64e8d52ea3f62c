// precompiled.h: what nearly every file of the library includes, compiled once. The Makefile puts it before each file where g++
// compiles; files still include what they use, and compile without it.
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <utility>
#include <vector>
