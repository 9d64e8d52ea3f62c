// block_row.h: sums of 6x6 blocks times the values of particles, in vectors of 16 bytes.
#pragma once

#include <algorithm>
#include <cstring>
#include <type_traits>

#include "linalg/block_matrix.h"

namespace kiln::linalg {

/// 16 bytes of neighbours in memory.
template <typename Real>
struct Lanes {
    using Type [[gnu::vector_size(16)]] = Real;
    static constexpr int count = 16 / static_cast<int>(sizeof(Real));
    /// Parts in which six values are read, and the first value of each: 0 to 3 and 2 to 5 in single precision.
    static constexpr int parts_of_six = (6 + count - 1) / count;
    static constexpr int first(int part) { return std::min(part * count, 6 - count); }

    static Type load(const Real* from) {
        Type lanes;
        std::memcpy(&lanes, from, sizeof lanes);
        return lanes;
    }
};

/// A row of a block matrix, or of a transposed one, times several fields at once; lanes are fields. Each value is summed in the
/// order of the calls.
template <typename Real, int width, bool transposed = false>
class RowSum {
   public:
    void add(const Eigen::Matrix<Real, 6, 6>& block, const Values<Real, width>& x) {
#pragma GCC unroll 1
        for (int first = 0; first < 6; first += rows_at_once) {
            Vector sum[rows_at_once][parts];
            std::memcpy(sum, sum_[first], sizeof sum);
#pragma GCC unroll 6
            for (int column = 0; column < 6; ++column) {
                Vector of_column[parts];
#pragma GCC unroll 4
                for (int part = 0; part < parts; ++part)
                    of_column[part] = Lanes<Real>::load(x.data() + column * width + part * Lanes<Real>::count);
#pragma GCC unroll 6
                for (int k = 0; k < rows_at_once; ++k) {
                    const Real factor = block.data()[transposed ? 6 * (first + k) + column : 6 * column + first + k];
#pragma GCC unroll 4
                    for (int part = 0; part < parts; ++part) sum[k][part] += factor * of_column[part];
                }
            }
            std::memcpy(sum_[first], sum, sizeof sum);
        }
    }

    Values<Real, width> values() const {
        Values<Real, width> values;
        std::memcpy(values.data(), sum_, sizeof sum_);
        return values;
    }

   private:
    using Vector = typename Lanes<Real>::Type;
    static constexpr int parts = width / Lanes<Real>::count;
    static constexpr int rows_at_once = 3;  // as many sums as a processor without AVX holds
    static_assert(width % Lanes<Real>::count == 0);

    Vector sum_[6][parts] = {};
};

/// Times one field; lanes are rows of the blocks.
template <typename Real>
class RowSum<Real, 1, false> {
   public:
    void add(const Eigen::Matrix<Real, 6, 6>& block, const Values<Real, 1>& x) {
#pragma GCC unroll 6
        for (int column = 0; column < 6; ++column) {
#pragma GCC unroll 3
            for (int part = 0; part < parts; ++part)
                sum_[part] += Lanes<Real>::load(block.data() + 6 * column + Lanes<Real>::first(part)) * x[column];
        }
    }

    Values<Real, 1> values() const {
        Values<Real, 1> values;
        for (int part = 0; part < parts; ++part)
            std::memcpy(values.data() + Lanes<Real>::first(part), &sum_[part], sizeof sum_[part]);
        return values;
    }

   private:
    static constexpr int parts = Lanes<Real>::parts_of_six;
    typename Lanes<Real>::Type sum_[parts] = {};
};

/// Transposed, times one field; lanes are rows of the blocks, added up when all blocks are.
template <typename Real>
class RowSum<Real, 1, true> {
   public:
    void add(const Eigen::Matrix<Real, 6, 6>& block, const Values<Real, 1>& x) {
        Vector factor[parts];
#pragma GCC unroll 3
        for (int part = 0; part < parts; ++part) {
            factor[part] = Lanes<Real>::load(x.data() + Lanes<Real>::first(part));
            // Values that the part before has are not counted twice.
            for (int lane = 0; lane < part * Lanes<Real>::count - Lanes<Real>::first(part); ++lane) factor[part][lane] = Real{0};
        }
#pragma GCC unroll 6
        for (int row = 0; row < 6; ++row) {
#pragma GCC unroll 3
            for (int part = 0; part < parts; ++part)
                sum_[row] += Lanes<Real>::load(block.data() + 6 * row + Lanes<Real>::first(part)) * factor[part];
        }
    }

    Values<Real, 1> values() const {
        Values<Real, 1> values;
        for (int row = 0; row < 6; ++row) {
            values[row] = sum_[row][0];
            for (int lane = 1; lane < Lanes<Real>::count; ++lane) values[row] += sum_[row][lane];
        }
        return values;
    }

   private:
    using Vector = typename Lanes<Real>::Type;
    static constexpr int parts = Lanes<Real>::parts_of_six;
    Vector sum_[6] = {};
};

/// A block and what it is multiplied with.
template <typename Real, int width>
struct Term {
    const Eigen::Matrix<Real, 6, 6>* block;
    const Values<Real, width>* x;
};

/// Sum of block times x over term_at(0) to term_at(count - 1).
template <typename Real, int width, bool transposed = false, typename TermAt>
Values<Real, width> sum_of_terms(std::int64_t count, const TermAt& term_at) {
    RowSum<Real, width, transposed> sum;
    for (std::int64_t k = 0; k < count; ++k) {
        const Term<Real, width> term = term_at(k);
        sum.add(*term.block, *term.x);
    }
    return sum.values();
}

}  // namespace kiln::linalg
