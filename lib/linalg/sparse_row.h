// sparse_row.h: a row of blocks that is summed column by column.
#pragma once

#include <algorithm>
#include <vector>

#include "core/parallel.h"
#include "linalg/block_matrix.h"

namespace kiln::linalg {

/// Columns are found through a table as long as the row; blocks are summed in the order of the calls.
class SparseRow {
   public:
    explicit SparseRow(std::size_t columns) : slot_(columns, -1) {}

    /// The block of a column, zero at first.
    Mat6& at(std::int32_t column) {
        std::int32_t& slot = slot_[static_cast<std::size_t>(column)];
        if (slot < 0) {
            slot = static_cast<std::int32_t>(column_.size());
            column_.push_back(column);
            block_.push_back(Mat6::Zero());
        }
        return block_[static_cast<std::size_t>(slot)];
    }

    /// Writes the row to the end of a matrix and begins the next one.
    void end_row(BlockMatrix& matrix) {
        std::sort(column_.begin(), column_.end());
        for (const std::int32_t column : column_) {
            std::int32_t& slot = slot_[static_cast<std::size_t>(column)];
            matrix.column.push_back(column);
            matrix.block.push_back(block_[static_cast<std::size_t>(slot)]);
            slot = -1;
        }
        matrix.start.push_back(static_cast<std::int64_t>(matrix.column.size()));
        column_.clear();
        block_.clear();
    }

   private:
    std::vector<std::int32_t> slot_, column_;
    std::vector<Mat6> block_;
};

/// A matrix of so many rows, in chunks one after the other; add(row, sum) adds the blocks of a row to a SparseRow.
template <typename AddRow>
BlockMatrix matrix_of_rows(std::int32_t rows, std::int32_t columns, const AddRow& add) {
    constexpr std::size_t rows_in_chunk = 256;
    const auto count = static_cast<std::size_t>(rows);
    std::vector<BlockMatrix> parts((count + rows_in_chunk - 1) / rows_in_chunk);
    for_chunks(parts.size(), [&](std::size_t part) {
        SparseRow sum(static_cast<std::size_t>(columns));
        for (std::size_t row = part * rows_in_chunk; row < std::min(count, (part + 1) * rows_in_chunk); ++row) {
            add(static_cast<std::int32_t>(row), sum);
            sum.end_row(parts[part]);
        }
    });
    return joined(columns, std::move(parts));
}

}  // namespace kiln::linalg
