// multigrid.h: preconditioner for bonded particles by smoothed aggregation, coarse freedoms being the rigid motions of aggregates.
#pragma once

#include <Eigen/Cholesky>
#include <tuple>
#include <vector>

#include "linalg/block_matrix.h"
#include "linalg/node_geometry.h"

namespace kiln::linalg {

/// One V-cycle with polynomial smoothing: symmetric, positive definite, and independent of the number of threads.
/// Vanek, Mandel & Brezina 1996 (smoothed aggregation); the aggregates' six rigid motions need no orthogonalisation, since a coarse
/// node is again a point with a displacement and a rotation. Smoother: Chebyshev iteration on the block-Jacobi matrix (Adams et al.
/// 2003). Levels are built in double precision and kept as Real: what single precision rounds off is far less than what one cycle
/// leaves.
template <typename Real>
class BasicMultigrid {
   public:
    /// matrix: symmetric positive definite, not needed afterwards; max_eigenvalue: bound for that of the block-Jacobi matrix.
    /// Throws Error where nodes are too many for a dense factorisation and none is connected to another.
    BasicMultigrid(const BlockMatrix& matrix, NodeGeometry geometry, double max_eigenvalue);
    BasicMultigrid(const BasicMultigrid&) = delete;  // as large as the matrix
    BasicMultigrid& operator=(const BasicMultigrid&) = delete;

    /// z = M^-1 r, for one field or six at once.
    template <int width>
    void apply(const Batch<width>& r, Batch<width>& z);

    std::size_t levels() const { return levels_.size(); }
    /// Blocks of all levels over those of the finest.
    double complexity() const;

   private:
    struct Level {
        BasicBlockMatrix<Real> matrix;  // empty on the coarsest level
        std::size_t blocks = 0;         // of the matrix
        std::size_t nodes = 0;
        std::vector<Eigen::Matrix<Real, 6, 6>> inverse_diagonal;
        double max_eigenvalue = 0.0;
        BasicBlockMatrix<Real> prolongation;  // from the next coarser level
        ColumnIndex restriction;
    };
    template <int lanes>
    struct Fields {
        std::vector<Values<Real, lanes>> load, solution, step;
    };
    static constexpr int six = sizeof(Real) == 4 ? 8 : 6;  // lanes of six fields

    void build(const BlockMatrix& finest, NodeGeometry geometry, double max_eigenvalue);
    template <int lanes>
    void cycle(std::size_t index);
    template <int lanes>
    void smooth(const Level& level, Fields<lanes>& fields, bool from_zero) const;
    template <int lanes>
    void solve_coarsest(Fields<lanes>& fields) const;
    template <int lanes>
    std::vector<Fields<lanes>>& fields() { return std::get<std::vector<Fields<lanes>>>(fields_); }

    std::vector<Level> levels_;
    double scale_ = 1.0;  // a power of two by which all matrices were multiplied
    Eigen::LLT<Eigen::MatrixXd> coarsest_;
    std::tuple<std::vector<Fields<1>>, std::vector<Fields<six>>> fields_;  // of each level; empty until needed
};

using Multigrid = BasicMultigrid<float>;

}  // namespace kiln::linalg
