// homogenisation.h: elastic and conductivity tensors of a periodic image, by finite elements.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/stop.h"
#include "voxel/grid_stiffness.h"
#include "voxel/image.h"

namespace kiln::voxel {

/// A tensor of a periodic image and how well its equations are solved. Elastic: 6x6, Pa, Voigt's notation xx, yy, zz, yz, xz, xy
/// with engineering shear strains. Conductivity: 3x3, W/(m K).
struct Homogenised {
    Eigen::MatrixXd tensor;
    int iterations = 0;     // of all load cases
    double residual =
        0.0;  // largest of the load cases: norm of the unbalanced nodal forces over that of the load, in double precision
    bool converged = true;
};

/// Fields that answer the load cases on one grid, from which a solve on another grid of the same body may start.
struct Solutions {
    std::array<std::size_t, 3> count{};  // of the grid
    double edge = 0.0;                   // m, of a cube of a voxel's volume: the unit of the fields
    std::vector<GridField> fields;       // none: start from zero
};

/// Bytes that homogenise() takes for an image of so many voxels along the axes, that of the image not counted.
template <typename Medium>
double memory_of(const std::array<std::size_t, 3>& count);

/// Solves six uniform strains (or three uniform gradients) of the image, one after the other, by conjugate gradients with the
/// inverse of a homogeneous medium (fourier_inverse.h) as the preconditioner, in single precision, until the unbalanced forces are
/// `tolerance` of the load; what is then left is found in double precision, and taken up again where it is more than that.
///
/// media[n - 1] is that of phase n. The tensor is the bilinear form of the energy of two solutions, so that its error is of the
/// second order in theirs. It is symmetric, and too large where equations are not solved. Loose parts of the solid do not disturb.
/// solutions: those of another grid to start from; afterwards those of this one. Throws Interrupted, and Error for phases that no
/// medium belongs to.
template <typename Medium>
Homogenised homogenise(const Image& image, const std::vector<Medium>& media, double tolerance, const Watch& watch = {},
                       Solutions* solutions = nullptr);

extern template double memory_of<Conductor>(const std::array<std::size_t, 3>&);
extern template double memory_of<Solid>(const std::array<std::size_t, 3>&);
extern template Homogenised homogenise(const Image&, const std::vector<Conductor>&, double, const Watch&, Solutions*);
extern template Homogenised homogenise(const Image&, const std::vector<Solid>&, double, const Watch&, Solutions*);

/// Lame's constants, Pa, of Young's modulus, Pa, and Poisson's ratio, from -1 to below 0.5.
Solid solid(double young_modulus, double poisson_ratio);

}  // namespace kiln::voxel
