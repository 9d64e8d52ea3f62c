// block_matrix.h: sparse matrices of 6x6 blocks, one row of blocks a particle, and vectors of six values a particle.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "core/grouping.h"
#include "core/parallel.h"

namespace kiln::linalg {

/// Six values of a particle in each of `width` fields; what stands side by side in memory is one value of all fields.
template <typename Real, int width>
using Values = Eigen::Matrix<Real, 6, width, width == 1 ? Eigen::ColMajor : Eigen::RowMajor>;

using Vec6 = Values<double, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;

/// Several fields together: work on them reads a matrix once for all.
template <int width>
using Batch = std::vector<Values<double, width>>;

/// Six values a particle: force (N) and moment over the rotation length (N), or displacement (m) and rotation times that length
/// (m).
using Vector = Batch<1>;

/// One number for each field of a batch.
template <int width>
using PerField = Eigen::Array<double, 1, width>;

/// Rows, bonds or pairs from which it pays to wake threads for a loop over them.
inline constexpr std::size_t worth_threads = 1500;

/// Compressed rows; columns ascend within a row.
template <typename Real>
struct BasicBlockMatrix {
    std::int32_t columns = 0;
    std::vector<std::int64_t> start{0};  // rows + 1
    std::vector<std::int32_t> column;
    std::vector<Eigen::Matrix<Real, 6, 6>> block;

    std::int32_t rows() const { return static_cast<std::int32_t>(start.size()) - 1; }
    /// Blocks of a row: [first, last) of column and block.
    std::int64_t first(std::int32_t row) const { return start[static_cast<std::size_t>(row)]; }
    std::int64_t last(std::int32_t row) const { return start[static_cast<std::size_t>(row) + 1]; }
};

using BlockMatrix = BasicBlockMatrix<double>;

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

/// Calls work(first, last) for chunks of the range of indices, which do not depend on the number of threads, and sums what it
/// gives for each field in their order.
template <int width, typename Work>
PerField<width> sum_over_chunks(std::size_t size, const Work& work) {
    constexpr std::size_t in_chunk = 1024;
    return sum_chunks((size + in_chunk - 1) / in_chunk, PerField<width>(PerField<width>::Zero()), [&](std::size_t chunk) {
        return PerField<width>(work(chunk * in_chunk, std::min(size, (chunk + 1) * in_chunk)));
    });
}

/// Norm of each field.
template <int width>
PerField<width> norms(const Batch<width>& x) {
    return sum_over_chunks<width>(x.size(), [&](std::size_t first, std::size_t last) {
        PerField<width> sum = PerField<width>::Zero();
        for (std::size_t i = first; i < last; ++i) sum += x[i].colwise().squaredNorm().array();
        return sum;
    }).sqrt();
}

/// Matrices under each other, of so many columns.
BlockMatrix joined(std::int32_t columns, std::vector<BlockMatrix> parts);

/// A B.
BlockMatrix product(const BlockMatrix& a, const BlockMatrix& b);

/// A^T B with the column index of A.
BlockMatrix transposed_product(const BlockMatrix& a, const ColumnIndex& columns, const BlockMatrix& b);

/// Sum of x_i . y_i in an order that does not depend on the number of threads.
double dot(const Vector& x, const Vector& y);

double norm(const Vector& x);

/// y += factor x.
void add(double factor, const Vector& x, Vector& y);

}  // namespace kiln::linalg
