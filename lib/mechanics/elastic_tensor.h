// elastic_tensor.h: elastic constants of a periodic cell of bonded particles.
#pragma once

#include "core/stop.h"
#include "mechanics/bond_network.h"
#include "mechanics/linear_solver.h"

namespace kiln::mechanics {

/// Stiffness in Voigt's notation, Pa: xx, yy, zz, yz, xz, xy; shear strains as in engineering, twice the tensor's.
struct ElasticTensor {
    Mat6 stiffness;      // of the cell in equilibrium
    Mat6 affine;         // particles moved by the uniform strain and not turned: an upper bound
    int iterations = 0;  // of all six solves
    double residual = 0.0;
    bool converged = true;
};

/// Six uniform strains of a periodic network in a cell of the given volume, m3, three at once. A network that is moved here does
/// not take memory while they are solved. other: see ElasticSolver. Throws Interrupted.
ElasticTensor elastic_tensor(BondNetwork network, double volume, double tolerance, const StopRequest& stop = {},
                             const LinearSolverMaker& other = {});

/// What a tensor means for a body without texture.
struct IsotropicAverage {
    double young_modulus, shear_modulus, bulk_modulus;  // Pa, of Voigt's average: the same strain in all directions
    double poisson_ratio;
    double anisotropy;  // 0 for an isotropic tensor: 5 G_V/G_R + K_V/K_R - 6 (Ranganathan & Ostoja-Starzewski 2008)
};

/// Throws Error for a tensor that is not positive definite.
IsotropicAverage isotropic_average(const Mat6& stiffness);

/// The stiffness with another Poisson's ratio and the same Young's modulus of its isotropic average: the bulk modulus and the rest
/// are scaled. Throws Error for a tensor that is not positive definite, or a ratio not between -1 and 0.5.
Mat6 with_poisson_ratio(const Mat6& stiffness, double poisson_ratio);

/// Young's moduli along x, y and z, Pa: 1/S_aa of the inverse of the stiffness, pulled along an axis with free faces around. Their
/// mean differs from the isotropic average by up to a tenth in a small cell. Throws Error for a tensor that is not positive
/// definite.
Vec3 axial_moduli(const Mat6& stiffness);

}  // namespace kiln::mechanics
