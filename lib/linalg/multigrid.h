// multigrid.h: preconditioner for bonded particles by smoothed aggregation, coarse freedoms being the rigid motions of aggregates.
#pragma once

#include <Eigen/Cholesky>
#include <tuple>
#include <vector>

#include "linalg/block_matrix.h"
#include "linalg/node_geometry.h"
#include "linalg/springs.h"

namespace kiln::linalg {

/// One V-cycle with polynomial smoothing: symmetric, positive definite, and independent of the number of threads.
/// Vanek, Mandel & Brezina 1996 (smoothed aggregation); the aggregates' six rigid motions need no orthogonalisation, since a coarse
/// node is again a point with a displacement and a rotation. Smoother: Chebyshev iteration on the block-Jacobi matrix (Adams et al.
/// 2003). The finest level is made of springs, also where it smooths what comes from the aggregates; the others are block matrices.
/// Levels are built in double precision and kept as Real: what single precision rounds off is far less than what one cycle leaves.
template <typename Real>
class BasicMultigrid {
   public:
    /// matrix: symmetric positive definite, not needed afterwards; max_eigenvalue: bound for that of the block-Jacobi matrix.
    /// Throws Error where nodes are too many for a dense factorisation and none is connected to another.
    BasicMultigrid(const Springs<double>& matrix, NodeGeometry geometry, double max_eigenvalue);
    BasicMultigrid(const BasicMultigrid&) = delete;  // large
    BasicMultigrid& operator=(const BasicMultigrid&) = delete;

    /// Motions of each field in a unit of its own.
    template <int width>
    struct Response {
        const std::vector<Freedoms<Real, width>>& motion;  // until the next call
        PerField<width> unit;
    };

    /// M^-1 r, for one field or three at once; size: the norms of r.
    template <int width>
    Response<width> apply(const Batch<width>& r, const PerField<width>& size);

    std::size_t levels() const { return levels_.size() + 1; }
    /// Blocks of all levels over those of the finest, if it had any.
    double complexity() const;

   private:
    using Block = Eigen::Matrix<Real, 6, 6>;
    struct Finest {
        Springs<Real> springs;
        std::vector<Block> inverse_diagonal;
        double max_eigenvalue = 0.0;
        std::vector<std::int32_t> aggregate;         // of each node
        std::vector<std::array<Real, 3>> arm;        // from its root
        Grouping<std::int32_t> members;              // of each aggregate
    };
    struct Level {
        BasicBlockMatrix<Real> matrix;  // empty on the coarsest level
        std::size_t blocks = 0;         // of the matrix
        std::size_t nodes = 0;
        std::vector<Block> inverse_diagonal;
        double max_eigenvalue = 0.0;
        BasicBlockMatrix<Real> prolongation;  // from the next coarser level
        ColumnIndex restriction;
    };
    template <int width>
    struct FinestFields {
        std::vector<Freedoms<Real, width>> load, solution, other, rest;  // other: the solution before or after a step
    };
    template <int lanes>
    struct Fields {
        std::vector<Values<Real, lanes>> load, solution, step;
    };
    template <int width>
    struct AllFields {  // empty until needed
        static constexpr int lanes = width == 1 ? 1 : 4;
        FinestFields<width> finest;
        std::vector<Fields<lanes>> coarser;
    };

    BlockMatrix build_finest(const Springs<double>& matrix, NodeGeometry& geometry, double max_eigenvalue);
    void build_coarser(BlockMatrix matrix, NodeGeometry geometry);
    void factorise(Eigen::MatrixXd matrix);
    template <int width>
    AllFields<width>& fields();
    template <int width>
    void cycle(AllFields<width>& fields);
    template <int width>
    void step(const std::vector<Freedoms<Real, width>>& load, const std::vector<Freedoms<Real, width>>& x,
              std::vector<Freedoms<Real, width>>& to, double memory, double gain) const;
    template <int lanes>
    void cycle(std::vector<Fields<lanes>>& fields, std::size_t index) const;
    template <int lanes>
    void smooth(const Level& level, Fields<lanes>& fields, bool from_zero) const;
    template <int lanes, typename Load, typename Solution>
    void solve_coarsest(const Load& load, Solution& solution) const;

    Finest finest_;
    std::vector<Level> levels_;
    double scale_ = 1.0;  // by which all matrices were multiplied
    Eigen::LLT<Eigen::MatrixXd> coarsest_;
    std::tuple<AllFields<1>, AllFields<3>> fields_;
};

using Multigrid = BasicMultigrid<float>;

}  // namespace kiln::linalg
