// spring_coarsening.cpp: products of springs and prolongation, chunk by chunk, and their sum over the chunks.
#include "linalg/spring_coarsening.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <tuple>

#include "linalg/sparse_row.h"

namespace kiln::linalg {

namespace {

std::size_t at(std::int64_t index) { return static_cast<std::size_t>(index); }

/// A spring as one of its nodes sees it.
struct End {
    std::int32_t other;
    Vec3 arm;  // from the node to the spring's middle
    const Spring<double>& spring;

    /// Stiffness against relative displacement and rotation times a vector.
    Vec3 pulled(const Vec3& v) const { return spring.shear * v + (spring.axial * arm.dot(v)) * arm; }
    Vec3 turned(const Vec3& v) const { return spring.bending * v + (spring.twisting * arm.dot(v)) * arm; }
};

// Blocks are kept transposed: a column holds what one force or moment at a node is by the six motions of an aggregate.

/// Adds what holds the node where its side of the spring moves as a rigid body about a point, `from` it to the spring's middle.
void add_rigid(const End& end, const Vec3& from, double sign, Mat6& sum) {
    Vec6 force[3];
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3 pulled = sign * end.pulled(Vec3::Unit(axis));
        force[axis] << pulled, from.cross(pulled);
        sum.col(axis) += force[axis];
    }
    for (int axis = 0; axis < 3; ++axis) {
        const int next = (axis + 1) % 3, last = (axis + 2) % 3;
        sum.col(3 + axis) += end.arm[next] * force[last] - end.arm[last] * force[next];
        sum.col(3 + axis).tail<3>() += sign * end.turned(Vec3::Unit(axis));
    }
}

/// Adds what holds the node where the other one moves by `motion`.
void add_other(const End& end, const Mat6& motion, Mat6& sum) {
    const Vec3& arm = end.arm;
    Vec6 moved[3], force[3];  // of the spring's middle
    for (int axis = 0; axis < 3; ++axis) {
        const int next = (axis + 1) % 3, last = (axis + 2) % 3;
        moved[axis] = motion.col(axis) + arm[next] * motion.col(3 + last) - arm[last] * motion.col(3 + next);
    }
    const Vec6 along = end.spring.axial * (arm[0] * moved[0] + arm[1] * moved[1] + arm[2] * moved[2]);
    const Vec6 about = end.spring.twisting * (arm[0] * motion.col(3) + arm[1] * motion.col(4) + arm[2] * motion.col(5));
    for (int axis = 0; axis < 3; ++axis) {
        force[axis] = end.spring.shear * moved[axis] + arm[axis] * along;
        sum.col(axis) -= force[axis];
    }
    for (int axis = 0; axis < 3; ++axis) {
        const int next = (axis + 1) % 3, last = (axis + 2) % 3;
        sum.col(3 + axis) -= arm[next] * force[last] - arm[last] * force[next] + end.spring.bending * motion.col(3 + axis) +
                             arm[axis] * about;
    }
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

    /// What a chunk adds to the coarse matrix: these rows, of each what stands on the diagonal and right of it.
    struct Part {
        std::vector<std::int32_t> row;
        BlockMatrix blocks;
    };

    Part part(std::size_t chunk) const {
        const auto [first, last] = springs_.nodes_of(chunk);
        const std::vector<std::int32_t> outside = neighbours_outside(chunk);
        SparseRow sum(aggregates_.root.size());
        BlockMatrix prolongation, product;  // rows: own nodes, then those outside; own nodes
        BlockMatrix rigid;                  // of own nodes: A R
        std::vector<Mat6> diagonal;         // of own nodes: D R
        for (std::size_t node = first; node < last; ++node) {
            diagonal.push_back(add_rigid_product(node, sum));
            sum.end_row(rigid);
            add_prolongation(node, rigid, prolongation);
        }
        BlockMatrix forces;
        for (const std::int32_t node : outside) {
            add_rigid_product(at(node), sum);
            forces = {};
            sum.end_row(forces);
            add_prolongation(at(node), forces, prolongation);
        }
        const auto row_of = [&, first = first, last = last](std::size_t node) {
            if (node >= first && node < last) return static_cast<std::int32_t>(node - first);
            const auto place = std::lower_bound(outside.begin(), outside.end(), static_cast<std::int32_t>(node));
            return static_cast<std::int32_t>(last - first + at(place - outside.begin()));
        };
        for (std::size_t node = first; node < last; ++node) {
            // D P = D R - damping A R.
            const auto row = static_cast<std::int32_t>(node - first);
            for (std::int64_t k = rigid.first(row); k < rigid.last(row); ++k)
                sum.at(rigid.column[at(k)]) -= damping_ * rigid.block[at(k)];
            sum.at(aggregates_.of[node]) += diagonal[at(row)];
            for_ends_at(node, [&](const End& end) {
                const std::int32_t other = row_of(at(end.other));
                for (std::int64_t k = prolongation.first(other); k < prolongation.last(other); ++k)
                    add_other(end, prolongation.block[at(k)], sum.at(prolongation.column[at(k)]));
            });
            sum.end_row(product);
        }
        // By columns of the prolongation.
        std::vector<std::tuple<std::int32_t, std::int32_t, std::int64_t>> entries;  // column, row, block
        for (std::int32_t row = 0; row < product.rows(); ++row)
            for (std::int64_t k = prolongation.first(row); k < prolongation.last(row); ++k)
                entries.emplace_back(prolongation.column[at(k)], row, k);
        std::sort(entries.begin(), entries.end());
        Part part;
        for (std::size_t k = 0; k < entries.size(); ++k) {
            const auto [column, row, block] = entries[k];
            for (std::int64_t p = product.last(row) - 1; p >= product.first(row) && product.column[at(p)] >= column; --p)
                sum.at(product.column[at(p)]).noalias() +=
                    prolongation.block[at(block)].lazyProduct(product.block[at(p)].transpose());
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

    /// Calls visit(end) for each spring at a node, for one with both ends there twice.
    template <typename Visit>
    void for_ends_at(std::size_t node, const Visit& visit) const {
        for (const std::uint32_t k : springs_at_.of(node)) {
            const Spring<double>& spring = springs_.springs()[k];
            const Eigen::Map<const Vec3> arm(spring.arm);
            if (at(spring.first) == node) visit(End{spring.second, arm, spring});
            if (at(spring.second) == node) visit(End{spring.first, -arm, spring});
        }
    }

    /// Adds the node's row of A R to the sum; gives what its own aggregate adds by the diagonal.
    Mat6 add_rigid_product(std::size_t node, SparseRow& sum) const {
        Mat6 diagonal = Mat6::Zero();
        for_ends_at(node, [&](const End& end) {
            add_rigid(end, arms_[node] + end.arm, 1.0, diagonal);
            add_rigid(end, arms_[at(end.other)] - end.arm, -1.0, sum.at(aggregates_.of[at(end.other)]));
        });
        for (const auto& [held, stiffness] : springs_.held())
            if (held == node) diagonal += rigid_motion(arms_[node]).transpose() * stiffness.asDiagonal();
        sum.at(aggregates_.of[node]) += diagonal;
        return diagonal;
    }

    /// The node's row of P, by the last row of A R.
    void add_prolongation(std::size_t node, const BlockMatrix& rigid, BlockMatrix& prolongation) const {
        const std::int32_t row = rigid.rows() - 1;
        const Mat6 factor = -damping_ * inverse_diagonal_[node];
        for (std::int64_t k = rigid.first(row); k < rigid.last(row); ++k) {
            prolongation.column.push_back(rigid.column[at(k)]);
            Mat6& block = prolongation.block.emplace_back(rigid.block[at(k)].lazyProduct(factor));
            if (rigid.column[at(k)] == aggregates_.of[node]) block += rigid_motion(arms_[node]).transpose();
        }
        prolongation.start.push_back(static_cast<std::int64_t>(prolongation.column.size()));
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
    const BlockMatrix right = matrix_of_rows(count, count, [&](std::int32_t row, SparseRow& sum) {
        for (const Place& place : places.of(at(row))) {
            const BlockMatrix& from = parts[place.part].blocks;
            for (std::int64_t k = from.first(place.row); k < from.last(place.row); ++k)
                sum.at(from.column[at(k)]) += from.block[at(k)];
        }
    });
    parts = {};
    const ColumnIndex columns = column_index(right);
    return matrix_of_rows(count, count, [&](std::int32_t row, SparseRow& sum) {
        for (const auto& [above, block] : columns.of(at(row)))
            if (above != row) sum.at(above) = right.block[at(block)].transpose();
        for (std::int64_t k = right.first(row); k < right.last(row); ++k) sum.at(right.column[at(k)]) = right.block[at(k)];
    });
}

}  // namespace kiln::linalg
