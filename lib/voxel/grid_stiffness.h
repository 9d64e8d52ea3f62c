// grid_stiffness.h: the stiffness of an image whose voxels are trilinear hexahedra, without a matrix.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "linalg/fourier_inverse.h"
#include "linalg/periodic_grid.h"

namespace kiln::voxel {

using linalg::GridField, linalg::PeriodicGrid;

/// What voxels of a phase are made of is what a homogeneous grid may be made of.
using Conductor = linalg::HomogeneousConductor;
using Solid = linalg::HomogeneousSolid;

/// Gradient of a potential (1x3) or of displacements (3x3), the same everywhere; row: component, column: axis. Or what answers it.
template <typename Medium>
using Gradient = Eigen::Matrix<double, static_cast<int>(Medium::components), 3>;

/// Forces of a field, and the flux or stress that goes with it.
template <typename Medium>
struct Unbalanced {
    double norm2 = 0.0;                               // sum of the squares of the nodal forces
    Gradient<Medium> flux = Gradient<Medium>::Zero(); // sum over the voxels of the mean flux or stress times the volume

    Unbalanced& operator+=(const Unbalanced& other) {
        norm2 += other.norm2;
        flux += other.flux;
        return *this;
    }
};

/// Stiffness K of the nodal values of a periodic image. A voxel's nodes are its corners; node (i, j, k) is the one of voxel
/// (i, j, k) nearest to the origin. Element matrices are integrated exactly. In the sums and differences of the eight nodal values
/// along the three axes an element's matrix falls apart into its symmetries, a few products each (the reflections of the box
/// commute with it), which is what makes a product cheap.
template <typename Medium>
class GridStiffness {
   public:
    static constexpr std::size_t components = Medium::components;

    /// phase: a number for each voxel, x running fastest; 0 is void, number n is of media[n - 1]. Both must outlive this.
    GridStiffness(const PeriodicGrid& grid, const std::vector<std::uint8_t>& phase, const std::vector<Medium>& media);

    /// forces <- K field, in single precision; gives field . forces. The same bytes for any number of threads.
    double apply(const GridField& field, GridField& forces) const;

    /// forces <- - K (field + gradient . position), computed in double precision and then rounded.
    Unbalanced<Medium> unbalanced(const GridField& field, const Gradient<Medium>& gradient, GridField& forces) const;

   private:
    PeriodicGrid grid_;
    const std::vector<std::uint8_t>& phase_;
    const std::vector<Medium>& media_;
    std::vector<char> solid_row_;  // of each row of voxels: whether anything in it is solid
};

extern template class GridStiffness<Conductor>;
extern template class GridStiffness<Solid>;

}  // namespace kiln::voxel
