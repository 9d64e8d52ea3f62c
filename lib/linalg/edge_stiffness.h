// edge_stiffness.h: edges with a stiffness along a direction and another across it: 3x3 blocks in 20 bytes in single precision.
#pragma once

#include <Eigen/Core>
#include <array>
#include <type_traits>
#include <vector>

#include "linalg/quad.h"

namespace kiln::linalg {

/// An edge's n, and kn - kt and kt in every place but the spare ones.
struct SpringLanes {
    Quad<double> direction, more, across;
};

/// Stiffness kt I + (kn - kt) n n^T of each edge of a network.
template <typename Real>
class EdgeStiffness {
   public:
    explicit EdgeStiffness(std::size_t edges) : direction_(edges), across_(edges) {}

    /// Unit vector n along an edge, either way; its stiffness is to be set anew.
    void set_direction(std::size_t edge, const Vec3& n) { direction_[edge] = quad<Real>(n); }

    /// kn and kt, in any one unit.
    void set(std::size_t edge, double along, double across) {
        direction_[edge].lanes[3] = static_cast<Real>(along - across);
        across_[edge] = static_cast<Real>(across);
    }

    /// Takes an edge of other springs.
    void copy(std::size_t edge, const EdgeStiffness& other, std::size_t of) {
        direction_[edge] = other.direction_[of];
        across_[edge] = other.across_[of];
    }

    /// An edge's n, kn - kt and kt.
    struct Entry {
        double x, y, z, more, across;

        Eigen::Matrix3d block() const {
            const Vec3 n(x, y, z);
            Eigen::Matrix3d block = more * n * n.transpose();
            block.diagonal().array() += across;
            return block;
        }
    };
    Entry spring(std::size_t edge) const {
        const auto& n = direction_[edge].lanes;
        return {n[0], n[1], n[2], n[3], across_[edge]};
    }

    SpringLanes lanes(std::size_t edge) const {
        const Quad<double> n = in_double(direction_[edge]), one{{1.0, 1.0, 1.0, 0.0}};
        return {only_vector(n), only_vector(all<3>(n)), static_cast<double>(across_[edge]) * one};
    }

    /// Block times v, whose spare place is zero; that of the product is anything.
    Quad<Real> product(std::size_t edge, Quad<Real> v) const {
        const Quad<Real> n = direction_[edge];
        return across_[edge] * v + sum(n * v) * (all<3>(n) * n);
    }

    /// The columns of the block times x, y and z of v, each.
    std::array<Quad<Real>, 3> columns(std::size_t edge, Quad<Real> v) const {
        const Quad<Real> n = direction_[edge], along = all<3>(n) * n, share = n * v, across = across_[edge] * v;
        const auto column = [&]<int axis>(std::integral_constant<int, axis>) {
            Quad<Real> unit;
            unit.lanes[axis] = Real{1};
            return only_vector(all<axis>(share) * along + unit * across);
        };
        return {column(std::integral_constant<int, 0>()), column(std::integral_constant<int, 1>()),
                column(std::integral_constant<int, 2>())};
    }

   private:
    std::vector<Quad<Real>> direction_;  // with kn - kt in the spare place
    std::vector<Real> across_;           // kt
};

}  // namespace kiln::linalg
