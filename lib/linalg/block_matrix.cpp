// block_matrix.cpp: products of block matrices and vectors, the same to the last bit for any number of threads.
#include "linalg/block_matrix.h"

#include <algorithm>
#include <cmath>

#include "linalg/block_row.h"

namespace kiln::linalg {

namespace {

std::size_t at(std::int64_t index) { return static_cast<std::size_t>(index); }

constexpr std::int32_t rows_in_chunk = 1024;

/// Rows of a product one at a time. `terms(row, visit)` calls visit(left block, row of b, transposed) for each term of the row.
template <typename Terms>
BlockMatrix sum_of_rows(std::int32_t rows, const BlockMatrix& b, const Terms& terms) {
    BlockMatrix result;
    result.columns = b.columns;
    result.start.assign(at(rows) + 1, 0);
    const auto for_row_chunks = [&](const auto& work) {
        for_chunks(at((rows + rows_in_chunk - 1) / rows_in_chunk), [&](std::size_t chunk) {
            const std::int32_t first = static_cast<std::int32_t>(chunk) * rows_in_chunk;
            work(first, std::min(rows, first + rows_in_chunk));
        });
    };
    for_row_chunks([&](std::int32_t first_row, std::int32_t last_row) {
        std::vector<std::int32_t> seen(at(b.columns), -1);
        for (std::int32_t row = first_row; row < last_row; ++row) {
            std::int64_t count = 0;
            terms(row, [&](const Mat6&, std::int32_t middle) {
                for (std::int64_t k = b.first(middle); k < b.last(middle); ++k) {
                    std::int32_t& last_seen = seen[at(b.column[at(k)])];
                    if (last_seen != row) ++count;
                    last_seen = row;
                }
            });
            result.start[at(row) + 1] = count;
        }
    });
    for (std::size_t row = 0; row < at(rows); ++row) result.start[row + 1] += result.start[row];
    result.column.resize(at(result.start.back()));
    result.block.resize(at(result.start.back()));
    for_row_chunks([&](std::int32_t first_row, std::int32_t last_row) {
        std::vector<std::int64_t> slot(at(b.columns), -1);
        for (std::int32_t row = first_row; row < last_row; ++row) {
            const std::int64_t first = result.first(row);
            std::int64_t end = first;
            terms(row, [&](const Mat6&, std::int32_t middle) {
                for (std::int64_t k = b.first(middle); k < b.last(middle); ++k) {
                    const std::int32_t column = b.column[at(k)];
                    if (slot[at(column)] >= 0) continue;
                    slot[at(column)] = 0;
                    result.column[at(end++)] = column;
                }
            });
            std::sort(result.column.begin() + first, result.column.begin() + end);
            for (std::int64_t k = first; k < end; ++k) {
                slot[at(result.column[at(k)])] = k;
                result.block[at(k)].setZero();
            }
            terms(row, [&](const Mat6& left, std::int32_t middle) {
                for (std::int64_t k = b.first(middle); k < b.last(middle); ++k) {
                    result.block[at(slot[at(b.column[at(k)])])].noalias() += left.lazyProduct(b.block[at(k)]);
                }
            });
            for (std::int64_t k = first; k < end; ++k) slot[at(result.column[at(k)])] = -1;
        }
    });
    return result;
}

template <int width>
Values<double, width> row_of_product(const BlockMatrix& matrix, std::int32_t row, const Batch<width>& x) {
    RowSum<double, width> sum;
    for (std::int64_t k = matrix.first(row); k < matrix.last(row); ++k) sum.add(matrix.block[at(k)], x[at(matrix.column[at(k)])]);
    return sum.values();
}

}  // namespace

ColumnIndex column_index(const BlockMatrix& matrix) {
    return group_by<ColumnEntry>(at(matrix.columns), [&](const auto& visit) {
        for (std::int32_t row = 0; row < matrix.rows(); ++row)
            for (std::int64_t k = matrix.first(row); k < matrix.last(row); ++k)
                visit(at(matrix.column[at(k)]), ColumnEntry{row, k});
    });
}

template <int width>
void multiply(const BlockMatrix& matrix, const Batch<width>& x, Batch<width>& y) {
    y.resize(at(matrix.rows()));
    for_rows(y.size(), [&](std::size_t row) { y[row] = row_of_product(matrix, static_cast<std::int32_t>(row), x); }, worth_threads);
}

template <int width>
PerField<width> multiply_and_dot(const BlockMatrix& matrix, const Batch<width>& x, Batch<width>& y) {
    y.resize(at(matrix.rows()));
    return sum_over_chunks<width>(y.size(), [&](std::size_t first, std::size_t last) {
        PerField<width> sum = PerField<width>::Zero();
        for (std::size_t row = first; row < last; ++row) {
            y[row] = row_of_product(matrix, static_cast<std::int32_t>(row), x);
            sum += x[row].cwiseProduct(y[row]).colwise().sum().array();
        }
        return sum;
    });
}

template <int width>
void residual(const BlockMatrix& matrix, const Batch<width>& x, const Batch<width>& b, Batch<width>& r) {
    r.resize(at(matrix.rows()));
    for_rows(r.size(), [&](std::size_t row) {
        r[row] = b[row] - row_of_product(matrix, static_cast<std::int32_t>(row), x);
    }, worth_threads);
}

template void multiply(const BlockMatrix&, const Batch<1>&, Batch<1>&);
template void multiply(const BlockMatrix&, const Batch<6>&, Batch<6>&);
template PerField<1> multiply_and_dot(const BlockMatrix&, const Batch<1>&, Batch<1>&);
template PerField<6> multiply_and_dot(const BlockMatrix&, const Batch<6>&, Batch<6>&);
template void residual(const BlockMatrix&, const Batch<1>&, const Batch<1>&, Batch<1>&);
template void residual(const BlockMatrix&, const Batch<6>&, const Batch<6>&, Batch<6>&);

BlockMatrix product(const BlockMatrix& a, const BlockMatrix& b) {
    return sum_of_rows(a.rows(), b, [&](std::int32_t row, const auto& visit) {
        for (std::int64_t k = a.first(row); k < a.last(row); ++k) visit(a.block[at(k)], a.column[at(k)]);
    });
}

BlockMatrix transposed_product(const BlockMatrix& a, const ColumnIndex& columns, const BlockMatrix& b) {
    return sum_of_rows(a.columns, b, [&](std::int32_t column, const auto& visit) {
        for (const auto& [row, block] : columns.of(at(column))) {
            const Mat6 transposed = a.block[at(block)].transpose();
            visit(transposed, row);
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

void combine(const Vector& x, double factor, Vector& y) {
    for_rows(x.size(), [&](std::size_t i) { y[i] = x[i] + factor * y[i]; }, worth_threads);
}

}  // namespace kiln::linalg
