// block_matrix.h: sparse matrices of 6x6 blocks, one row of blocks a particle, and vectors of six values a particle.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "core/grouping.h"

namespace kiln::linalg {

using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;

/// Six values a particle: force (N) and moment over the rotation length (N), or displacement (m) and rotation times that length
/// (m).
using Vector = std::vector<Vec6>;

/// Rows, bonds or pairs from which it pays to wake threads for a loop over them.
inline constexpr int worth_threads = 1500;

/// Compressed rows; columns ascend within a row.
struct BlockMatrix {
    std::int32_t columns = 0;
    std::vector<std::int64_t> start{0};  // rows + 1
    std::vector<std::int32_t> column;
    std::vector<Mat6> block;

    std::int32_t rows() const { return static_cast<std::int32_t>(start.size()) - 1; }
    /// Blocks of a row: [first, last) of column and block.
    std::int64_t first(std::int32_t row) const { return start[static_cast<std::size_t>(row)]; }
    std::int64_t last(std::int32_t row) const { return start[static_cast<std::size_t>(row) + 1]; }
};

/// A block of a column: its row, and its index in the matrix.
struct ColumnEntry {
    std::int32_t row;
    std::int64_t block;
};

/// Where the blocks of each column of a matrix stand, rows ascending.
using ColumnIndex = Grouping<ColumnEntry>;

ColumnIndex column_index(const BlockMatrix& matrix);

/// y = A x. Rows are summed one by one, so the number of threads does not change a bit.
void multiply(const BlockMatrix& matrix, const Vector& x, Vector& y);

/// r = b - A x.
void residual(const BlockMatrix& matrix, const Vector& x, const Vector& b, Vector& r);

/// A B.
BlockMatrix product(const BlockMatrix& a, const BlockMatrix& b);

/// A^T B with the column index of A.
BlockMatrix transposed_product(const BlockMatrix& a, const ColumnIndex& columns, const BlockMatrix& b);

/// Sum of x_i . y_i in an order that does not depend on the number of threads.
double dot(const Vector& x, const Vector& y);

double norm(const Vector& x);

/// y += factor x.
void add(double factor, const Vector& x, Vector& y);

/// y = x + factor y.
void combine(const Vector& x, double factor, Vector& y);

}  // namespace kiln::linalg
