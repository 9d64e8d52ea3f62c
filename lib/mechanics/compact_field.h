// compact_field.h: six values a node in 36 bytes, of which a reduced space keeps many.
#pragma once

#include <bit>
#include <cstdint>

#include "linalg/block_matrix.h"

namespace kiln::mechanics {

/// Numbers of 48 bits: those of a double without its last 16, so that rounding takes 4e-12 of a number. (Single precision takes
/// 6e-8, and forces that hold such a field: as much times the slenderness of the body, and times the root of its nodes.)
class CompactField {
   public:
    explicit CompactField(std::size_t nodes) : upper_(6 * nodes), lower_(6 * nodes) {}

    /// Nodes [first, last).
    void read(std::size_t first, std::size_t last, linalg::Vec6* values) const {
        double* to = values->data();
        const std::uint32_t* upper = &upper_[6 * first];
        const std::uint16_t* lower = &lower_[6 * first];
        const std::size_t count = 6 * (last - first);
        for (std::size_t k = 0; k < count; ++k)
            to[k] = std::bit_cast<double>(std::uint64_t{upper[k]} << 32 | std::uint64_t{std::uint32_t{lower[k]} << 16});
    }

    linalg::Vec6 operator[](std::size_t node) const {
        linalg::Vec6 values;
        read(node, node + 1, &values);
        return values;
    }

    void set(std::size_t node, const linalg::Vec6& values) {
        for (std::size_t k = 0; k < 6; ++k) {
            const auto bits = std::bit_cast<std::uint64_t>(values[static_cast<Eigen::Index>(k)]) + 0x8000;  // to the nearest
            upper_[6 * node + k] = static_cast<std::uint32_t>(bits >> 32);
            lower_[6 * node + k] = static_cast<std::uint16_t>(bits >> 16);
        }
    }

   private:
    std::vector<std::uint32_t> upper_;
    std::vector<std::uint16_t> lower_;
};

}  // namespace kiln::mechanics
