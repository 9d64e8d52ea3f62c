// multigrid.h: preconditioner for bonded particles by smoothed aggregation, coarse freedoms being the rigid motions of aggregates.
#pragma once

#include <Eigen/Cholesky>
#include <vector>

#include "linalg/block_matrix.h"
#include "linalg/node_geometry.h"

namespace kiln::linalg {

/// One V-cycle with polynomial smoothing: symmetric, positive definite, and independent of the number of threads.
/// Vanek, Mandel & Brezina 1996 (smoothed aggregation); the aggregates' six rigid motions need no orthogonalisation, since a coarse
/// node is again a point with a displacement and a rotation. Smoother: Chebyshev iteration on the block-Jacobi matrix (Adams et al.
/// 2003).
class Multigrid {
   public:
    /// matrix: symmetric positive definite, kept by reference; max_eigenvalue: bound for that of the block-Jacobi matrix.
    /// Throws Error where nodes are too many for a dense factorisation and none is connected to another.
    Multigrid(const BlockMatrix& matrix, NodeGeometry geometry, double max_eigenvalue);
    Multigrid(const Multigrid&) = delete;  // coarse levels refer to matrices of their own
    Multigrid& operator=(const Multigrid&) = delete;

    /// z = M^-1 r.
    void apply(const Vector& r, Vector& z);

    std::size_t levels() const { return levels_.size(); }
    /// Blocks of all levels over those of the finest.
    double complexity() const;

   private:
    struct Level {
        BlockMatrix own;  // empty on the finest level
        const BlockMatrix* matrix = nullptr;
        std::vector<Mat6> inverse_diagonal;
        double max_eigenvalue = 0.0;
        BlockMatrix prolongation;  // from the next coarser level
        ColumnIndex restriction;
        Vector load, solution, step;
    };

    void build(NodeGeometry geometry);
    void cycle(std::size_t index);
    void smooth(Level& level, bool from_zero);
    void solve_coarsest(Level& level);

    std::vector<Level> levels_;
    Eigen::LLT<Eigen::MatrixXd> coarsest_;
};

}  // namespace kiln::linalg
