// block_matrix.cpp: products of block matrices and vectors, the same to the last bit for any number of threads.
#include "linalg/block_matrix.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace kiln::linalg {

namespace {

std::size_t at(std::int64_t index) { return static_cast<std::size_t>(index); }

constexpr std::int64_t rows_in_chunk = 1024;

/// Rows of a product one at a time. `terms(row, visit)` calls visit(left block, row of b, transposed) for each term of the row.
template <typename Terms>
BlockMatrix sum_of_rows(std::int32_t rows, const BlockMatrix& b, const Terms& terms) {
    BlockMatrix result;
    result.columns = b.columns;
    result.start.assign(at(rows) + 1, 0);
#pragma omp parallel if (rows > worth_threads)
    {
        std::vector<std::int32_t> seen(at(b.columns), -1);
#pragma omp for schedule(dynamic, rows_in_chunk)
        for (std::int32_t row = 0; row < rows; ++row) {
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
    }
    for (std::size_t row = 0; row < at(rows); ++row) result.start[row + 1] += result.start[row];
    result.column.resize(at(result.start.back()));
    result.block.resize(at(result.start.back()));
#pragma omp parallel if (rows > worth_threads)
    {
        std::vector<std::int64_t> slot(at(b.columns), -1);
#pragma omp for schedule(dynamic, rows_in_chunk)
        for (std::int32_t row = 0; row < rows; ++row) {
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
    }
    return result;
}

/// Sums `term(first, last)` over fixed chunks of the index range, in their order.
template <typename Term>
double chunked_sum(std::int64_t size, const Term& term) {
    const std::int64_t chunks = (size + rows_in_chunk - 1) / rows_in_chunk;
    return sum_chunks(at(chunks), 0.0, [&](std::size_t chunk) {
        const auto first = static_cast<std::int64_t>(chunk) * rows_in_chunk;
        return term(first, std::min(size, first + rows_in_chunk));
    });
}

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
#pragma omp parallel for schedule(static) if (matrix.rows() > worth_threads)
    for (std::int32_t row = 0; row < matrix.rows(); ++row) {
        Vec6 sum = Vec6::Zero();
        for (std::int64_t k = matrix.first(row); k < matrix.last(row); ++k) {
            sum.noalias() += matrix.block[at(k)].lazyProduct(x[at(matrix.column[at(k)])]);
        }
        y[at(row)] = sum;
    }
}

void residual(const BlockMatrix& matrix, const Vector& x, const Vector& b, Vector& r) {
    r.resize(at(matrix.rows()));
#pragma omp parallel for schedule(static) if (matrix.rows() > worth_threads)
    for (std::int32_t row = 0; row < matrix.rows(); ++row) {
        Vec6 sum = b[at(row)];
        for (std::int64_t k = matrix.first(row); k < matrix.last(row); ++k) {
            sum.noalias() -= matrix.block[at(k)].lazyProduct(x[at(matrix.column[at(k)])]);
        }
        r[at(row)] = sum;
    }
}

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
    return chunked_sum(static_cast<std::int64_t>(x.size()), [&](std::int64_t first, std::int64_t last) {
        double sum = 0.0;
        for (std::int64_t i = first; i < last; ++i) sum += x[at(i)].dot(y[at(i)]);
        return sum;
    });
}

double norm(const Vector& x) { return std::sqrt(dot(x, x)); }

void add(double factor, const Vector& x, Vector& y) {
#pragma omp parallel for schedule(static) if (x.size() > worth_threads)
    for (std::size_t i = 0; i < x.size(); ++i) y[i] += factor * x[i];
}

void combine(const Vector& x, double factor, Vector& y) {
#pragma omp parallel for schedule(static) if (x.size() > worth_threads)
    for (std::size_t i = 0; i < x.size(); ++i) y[i] = x[i] + factor * y[i];
}

}  // namespace kiln::linalg
