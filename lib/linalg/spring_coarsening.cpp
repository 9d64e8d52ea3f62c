// spring_coarsening.cpp: products of springs and prolongation, chunk by chunk, and their sum over the chunks.
#include "linalg/spring_coarsening.h"

#include <algorithm>
#include <tuple>

#include "linalg/sparse_row.h"

namespace kiln::linalg {

namespace {

using Mat3 = Eigen::Matrix3d;

std::size_t at(std::int64_t index) { return static_cast<std::size_t>(index); }

/// block times the rigid motion at an arm.
Mat6 times_rigid(const Mat6& block, const Vec3& arm) {
    Mat6 product = block;
    product.rightCols<3>() += block.leftCols<3>() * rigid_motion(arm).topRightCorner<3, 3>();
    return product;
}

class Coarsening {
   public:
    Coarsening(const Springs<double>& springs, const std::vector<Mat6>& inverse_diagonal, double damping,
               const Aggregates& aggregates, const std::vector<Vec3>& arms)
        : springs_(springs),
          inverse_diagonal_(inverse_diagonal),
          damping_(damping),
          aggregates_(aggregates),
          arms_(arms),
          springs_at_(group_by<std::uint32_t>(springs.nodes(), [&](const auto& visit) {
              for (std::size_t k = 0; k < springs.springs().size(); ++k) {
                  const Spring<double>& spring = springs.springs()[k];
                  visit(at(spring.first), static_cast<std::uint32_t>(k));
                  if (spring.second != spring.first) visit(at(spring.second), static_cast<std::uint32_t>(k));
              }
          })) {}

    /// What a chunk adds to the coarse matrix: these rows.
    struct Part {
        std::vector<std::int32_t> row;
        BlockMatrix blocks;
    };

    Part part(std::size_t chunk) const {
        const auto [first, last] = springs_.nodes_of(chunk);
        const std::vector<std::int32_t> outside = neighbours_outside(chunk);
        SparseRow sum(aggregates_.root.size());
        BlockMatrix prolongation, product;  // rows: own nodes, then those outside; own nodes
        for (std::size_t node = first; node < last; ++node) add_prolongation(node, sum, prolongation);
        for (const std::int32_t node : outside) add_prolongation(at(node), sum, prolongation);
        const auto row_of = [&, first = first, last = last](std::size_t node) {
            if (node >= first && node < last) return static_cast<std::int32_t>(node - first);
            const auto place = std::lower_bound(outside.begin(), outside.end(), static_cast<std::int32_t>(node));
            return static_cast<std::int32_t>(last - first + at(place - outside.begin()));
        };
        for (std::size_t node = first; node < last; ++node) add_product(node, prolongation, row_of, sum, product);
        // By columns of the prolongation.
        std::vector<std::tuple<std::int32_t, std::int32_t, std::int64_t>> entries;  // column, row, block
        for (std::int32_t row = 0; row < product.rows(); ++row)
            for (std::int64_t k = prolongation.first(row); k < prolongation.last(row); ++k)
                entries.emplace_back(prolongation.column[at(k)], row, k);
        std::sort(entries.begin(), entries.end());
        Part part;
        for (std::size_t k = 0; k < entries.size(); ++k) {
            const auto [column, row, block] = entries[k];
            const Mat6 transposed = prolongation.block[at(block)].transpose();
            for (std::int64_t p = product.first(row); p < product.last(row); ++p)
                sum.at(product.column[at(p)]).noalias() += transposed.lazyProduct(product.block[at(p)]);
            if (k + 1 < entries.size() && std::get<0>(entries[k + 1]) == column) continue;
            part.row.push_back(column);
            sum.end_row(part.blocks);
        }
        return part;
    }

   private:
    std::vector<std::int32_t> neighbours_outside(std::size_t chunk) const {
        const auto [first, last] = springs_.nodes_of(chunk);
        std::vector<std::int32_t> outside;
        springs_.for_springs(chunk, [&, first = first, last = last](const Spring<double>& spring) {
            for (const std::int32_t node : {spring.first, spring.second})
                if (at(node) < first || at(node) >= last) outside.push_back(node);
        });
        std::sort(outside.begin(), outside.end());
        outside.erase(std::unique(outside.begin(), outside.end()), outside.end());
        return outside;
    }

    /// Calls visit(other node, block on the diagonal, block to the other node) for each spring at a node.
    template <typename Visit>
    void for_blocks_at(std::size_t node, const Visit& visit) const {
        for (const std::uint32_t k : springs_at_.of(node)) {
            const Spring<double>& spring = springs_.springs()[k];
            const SpringBlocks blocks = blocks_of(spring);
            if (spring.first == spring.second)
                visit(node, Mat6(blocks.ii + blocks.jj), Mat6(blocks.ij + blocks.ij.transpose()));
            else if (at(spring.first) == node)
                visit(at(spring.second), blocks.ii, blocks.ij);
            else
                visit(at(spring.first), blocks.jj, Mat6(blocks.ij.transpose()));
        }
        for (const auto& [held, stiffness] : springs_.held())
            if (held == node) visit(node, Mat6(stiffness.asDiagonal()), Mat6(Mat6::Zero()));
    }

    void add_prolongation(std::size_t node, SparseRow& sum, BlockMatrix& prolongation) const {
        const std::int32_t own = aggregates_.of[node];
        Mat6 diagonal = Mat6::Zero();
        for_blocks_at(node, [&](std::size_t other, const Mat6& on_diagonal, const Mat6& block) {
            diagonal += on_diagonal;
            sum.at(aggregates_.of[other]) += times_rigid(block, arms_[other]);
        });
        sum.at(own) += times_rigid(diagonal, arms_[node]);
        sum.end_row(prolongation);
        for (std::int64_t k = prolongation.start[prolongation.start.size() - 2]; k < prolongation.start.back(); ++k) {
            Mat6& block = prolongation.block[at(k)];
            block = (-damping_ * inverse_diagonal_[node]).lazyProduct(block).eval();
            if (prolongation.column[at(k)] == own) block += rigid_motion(arms_[node]);
        }
    }

    template <typename RowOf>
    void add_product(std::size_t node, const BlockMatrix& prolongation, const RowOf& row_of, SparseRow& sum,
                     BlockMatrix& product) const {
        Mat6 diagonal = Mat6::Zero();
        const auto add = [&](const Mat6& left, std::int32_t row) {
            for (std::int64_t k = prolongation.first(row); k < prolongation.last(row); ++k)
                sum.at(prolongation.column[at(k)]).noalias() += left.lazyProduct(prolongation.block[at(k)]);
        };
        for_blocks_at(node, [&](std::size_t other, const Mat6& on_diagonal, const Mat6& block) {
            diagonal += on_diagonal;
            add(block, row_of(other));
        });
        add(diagonal, row_of(node));
        sum.end_row(product);
    }

    const Springs<double>& springs_;
    const std::vector<Mat6>& inverse_diagonal_;
    double damping_;
    const Aggregates& aggregates_;
    const std::vector<Vec3>& arms_;
    Grouping<std::uint32_t> springs_at_;
};

}  // namespace

BlockMatrix coarse_matrix(const Springs<double>& springs, const std::vector<Mat6>& inverse_diagonal, double damping,
                          const Aggregates& aggregates, const std::vector<Vec3>& arms) {
    const Coarsening coarsening(springs, inverse_diagonal, damping, aggregates, arms);
    std::vector<Coarsening::Part> parts(springs.chunks());
    for_chunks(parts.size(), [&](std::size_t chunk) { parts[chunk] = coarsening.part(chunk); });
    struct Place {
        std::uint32_t part;
        std::int32_t row;
    };
    const Grouping<Place> places = group_by<Place>(aggregates.root.size(), [&](const auto& visit) {
        for (std::size_t part = 0; part < parts.size(); ++part)
            for (std::size_t row = 0; row < parts[part].row.size(); ++row)
                visit(at(parts[part].row[row]), Place{static_cast<std::uint32_t>(part), static_cast<std::int32_t>(row)});
    });
    const auto count = static_cast<std::int32_t>(aggregates.root.size());
    return matrix_of_rows(count, count, [&](std::int32_t row, SparseRow& sum) {
        for (const Place& place : places.of(at(row))) {
            const BlockMatrix& from = parts[place.part].blocks;
            for (std::int64_t k = from.first(place.row); k < from.last(place.row); ++k)
                sum.at(from.column[at(k)]) += from.block[at(k)];
        }
    });
}

}  // namespace kiln::linalg
