// extrapolation.h: what values on several grids say of a grid without end.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace kiln::voxel {

/// The power of a voxel's edge by which the error of a grid falls.
///
/// Measured on packings of 60 to 300 spheres: where necks have a length of their own, so that the gap around them has a width, the
/// second power describes grids of 6 to 24 voxels a radius; where spheres merely overlap and the gap closes to nothing the first.
enum class Order { first = 1, second = 2 };

struct Extrapolated {
    double value, error;
};

/// Weights whose sum with the values on the grids is the value at edge 0 of the line through them by least squares, in the edge to
/// the power of the order. One grid has weight 1. edges: of a voxel, in any unit, all different.
std::vector<double> extrapolation_weights(std::span<const double> edges, Order order);

/// The value of such a line at edge 0 and how far off it may be: twice the difference that the other order would make, and twice
/// the scatter of the values about the line (root mean square). At least two grids.
Extrapolated extrapolate(std::span<const double> edges, std::span<const double> values, Order order);

/// The same weights applied to tensors.
Eigen::MatrixXd extrapolate(std::span<const double> edges, const std::vector<Eigen::MatrixXd>& tensors, Order order);

}  // namespace kiln::voxel
