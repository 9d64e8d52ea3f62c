// random.h: random numbers whose stream is the same on every platform.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

namespace kiln::packing {

/// The C++ standard fixes the bits of mt19937_64 but not how its distributions use them; these conversions are our own.
class Random {
   public:
    explicit Random(std::uint64_t seed) : bits_(seed) {}

    /// Uniform in [0, 1), 53 random bits.
    double uniform() { return static_cast<double>(bits_() >> 11) * 0x1p-53; }

    /// Normal with mean 0 and deviation 1 (Box and Muller 1958; the second number of each pair is not used).
    double normal() {
        const double length = std::sqrt(-2.0 * std::log1p(-uniform()));
        return length * std::cos(2.0 * std::numbers::pi * uniform());
    }

   private:
    std::mt19937_64 bits_;
};

}  // namespace kiln::packing
