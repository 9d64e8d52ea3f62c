// block_matrix.cpp: products of block matrices and vectors, the same to the last bit for any number of threads.
#include "linalg/block_matrix.h"

#include <algorithm>
#include <cmath>

#include "linalg/block_row.h"
#include "linalg/sparse_row.h"

namespace kiln::linalg {

namespace {

std::size_t at(std::int64_t index) { return static_cast<std::size_t>(index); }

}  // namespace

ColumnIndex column_index(const BlockMatrix& matrix) {
    return group_by<ColumnEntry>(at(matrix.columns), [&](const auto& visit) {
        for (std::int32_t row = 0; row < matrix.rows(); ++row)
            for (std::int64_t k = matrix.first(row); k < matrix.last(row); ++k)
                visit(at(matrix.column[at(k)]), ColumnEntry{row, k});
    });
}

void multiply(const BlockMatrix& matrix, const Vector& x, Vector& y) {
    y.resize(at(matrix.rows()));
    for_rows(
        y.size(),
        [&](std::size_t row) {
            RowSum<double, 1> sum;
            for (std::int64_t k = matrix.start[row]; k < matrix.start[row + 1]; ++k)
                sum.add(matrix.block[at(k)], x[at(matrix.column[at(k)])]);
            y[row] = sum.values();
        },
        worth_threads);
}

BlockMatrix joined(std::int32_t columns, std::vector<BlockMatrix> parts) {
    BlockMatrix matrix;
    matrix.columns = columns;
    std::size_t blocks = 0;
    for (const BlockMatrix& part : parts) blocks += part.block.size();
    matrix.column.reserve(blocks);
    matrix.block.reserve(blocks);
    for (BlockMatrix& part : parts) {
        const std::int64_t before = matrix.start.back();
        for (std::int32_t row = 0; row < part.rows(); ++row) matrix.start.push_back(before + part.last(row));
        matrix.column.insert(matrix.column.end(), part.column.begin(), part.column.end());
        matrix.block.insert(matrix.block.end(), part.block.begin(), part.block.end());
        part = {};
    }
    return matrix;
}

BlockMatrix product(const BlockMatrix& a, const BlockMatrix& b) {
    return matrix_of_rows(a.rows(), b.columns, [&](std::int32_t row, SparseRow& sum) {
        for (std::int64_t k = a.first(row); k < a.last(row); ++k) {
            const std::int32_t middle = a.column[at(k)];
            for (std::int64_t p = b.first(middle); p < b.last(middle); ++p)
                sum.at(b.column[at(p)]).noalias() += a.block[at(k)].lazyProduct(b.block[at(p)]);
        }
    });
}

BlockMatrix transposed_product(const BlockMatrix& a, const ColumnIndex& columns, const BlockMatrix& b) {
    return matrix_of_rows(a.columns, b.columns, [&](std::int32_t column, SparseRow& sum) {
        for (const auto& [row, block] : columns.of(at(column))) {
            const Mat6 transposed = a.block[at(block)].transpose();
            for (std::int64_t p = b.first(row); p < b.last(row); ++p)
                sum.at(b.column[at(p)]).noalias() += transposed.lazyProduct(b.block[at(p)]);
        }
    });
}

double dot(const Vector& x, const Vector& y) {
    return sum_over_chunks<1>(x.size(), [&](std::size_t first, std::size_t last) {
        double sum = 0.0;
        for (std::size_t i = first; i < last; ++i) sum += x[i].dot(y[i]);
        return PerField<1>(sum);
    })[0];
}

double norm(const Vector& x) { return std::sqrt(dot(x, x)); }

void add(double factor, const Vector& x, Vector& y) {
    for_rows(x.size(), [&](std::size_t i) { y[i] += factor * x[i]; }, worth_threads);
}

}  // namespace kiln::linalg
