// spring_force.h: what a spring between two nodes with six freedoms does to them, in vectors of four numbers: the axes of one
// field, or one component of three fields.
#pragma once

#include <cstdint>
#include <cstring>
#include <type_traits>

#include "core/types.h"
#include "linalg/block_matrix.h"

// Vectors of four doubles are passed only between functions that become one.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace kiln::linalg {

/// A spring between two nodes. With du = u_2 - u_1 + arm x (q_1 + q_2) and dq = q_2 - q_1 it pulls the first node along
///   f = shear du + axial (arm . du) arm   and turns it by the moment   m = bending dq + twisting (arm . dq) arm  at its middle.
/// Displacements u and rotations times the rotation length q in m, forces and moments over the rotation length in N.
template <typename Real>
struct Spring {
    std::int32_t first, second;
    Real arm[3];                          // half the vector from the first node to the second, over the rotation length
    Real shear, axial, bending, twisting;  // N/m
};

template <typename Real>
struct FourOf {
    using Type [[gnu::vector_size(4 * sizeof(Real))]] = Real;
};
template <typename Real>
using Four = typename FourOf<Real>::Type;

/// A vector in space, of one field (x, y, z and zero) or of three (and of a fourth that is zero).
template <typename Real, int width>
struct Arrow;

template <typename Real>
struct Arrow<Real, 1> {
    Four<Real> axes;
};

template <typename Real>
struct Arrow<Real, 3> {
    Four<Real> x, y, z;
};

/// What a node does, or what is done to it.
template <typename Real, int width>
struct alignas(4 * sizeof(Real)) Freedoms {  // functions for wider registers take vectors to be aligned
    Arrow<Real, width> u, q;

    static constexpr int size = width == 1 ? 8 : 24;
    /// Where a component of a field stands.
    static constexpr int place(int component, int field) {
        return width == 1 ? component + (component > 2 ? 1 : 0) : 4 * component + field;
    }
    Real* data() { return reinterpret_cast<Real*>(this); }
    const Real* data() const { return reinterpret_cast<const Real*>(this); }
};

template <int width, typename Real>
[[gnu::always_inline]] inline Values<double, width> values_of(const Freedoms<Real, width>& motion) {
    Values<double, width> values;
    for (int component = 0; component < 6; ++component)
        for (int field = 0; field < width; ++field)
            values(component, field) = static_cast<double>(motion.data()[Freedoms<Real, width>::place(component, field)]);
    return values;
}

template <typename Real, int width>
[[gnu::always_inline]] inline Freedoms<Real, width> motion_of(const Values<double, width>& values) {
    Freedoms<Real, width> motion{};
    for (int component = 0; component < 6; ++component)
        for (int field = 0; field < width; ++field)
            motion.data()[Freedoms<Real, width>::place(component, field)] = static_cast<Real>(values(component, field));
    return motion;
}

#define KILN_INLINE [[gnu::always_inline]] inline

template <typename Real>
KILN_INLINE Arrow<Real, 1> operator+(const Arrow<Real, 1>& a, const Arrow<Real, 1>& b) { return {a.axes + b.axes}; }
template <typename Real>
KILN_INLINE Arrow<Real, 1> operator-(const Arrow<Real, 1>& a, const Arrow<Real, 1>& b) { return {a.axes - b.axes}; }
template <typename Real>
KILN_INLINE Arrow<Real, 3> operator+(const Arrow<Real, 3>& a, const Arrow<Real, 3>& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <typename Real>
KILN_INLINE Arrow<Real, 3> operator-(const Arrow<Real, 3>& a, const Arrow<Real, 3>& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}

template <typename Real, int width>
KILN_INLINE Freedoms<Real, width> operator+(const Freedoms<Real, width>& a, const Freedoms<Real, width>& b) {
    return {a.u + b.u, a.q + b.q};
}
template <typename Real, int width>
KILN_INLINE Freedoms<Real, width> operator-(const Freedoms<Real, width>& a, const Freedoms<Real, width>& b) {
    return {a.u - b.u, a.q - b.q};
}
template <typename Real>
KILN_INLINE Arrow<Real, 1> operator*(Real factor, const Arrow<Real, 1>& a) { return {factor * a.axes}; }
template <typename Real>
KILN_INLINE Arrow<Real, 3> operator*(Real factor, const Arrow<Real, 3>& a) { return {factor * a.x, factor * a.y, factor * a.z}; }
template <typename Real, int width>
KILN_INLINE Freedoms<Real, width> operator*(std::type_identity_t<Real> factor, const Freedoms<Real, width>& a) {
    return {factor * a.u, factor * a.q};
}

/// Six freedoms times a block.
template <typename Real>
KILN_INLINE Freedoms<Real, 1> operator*(const Eigen::Matrix<Real, 6, 6>& block, const Freedoms<Real, 1>& a) {
    Four<Real> upper{}, lower{};  // rows 0 to 3 and 2 to 5
    for (int column = 0; column < 6; ++column) {
        Four<Real> rows;
        const Real factor = a.data()[Freedoms<Real, 1>::place(column, 0)];
        std::memcpy(&rows, block.data() + 6 * column, sizeof rows);
        upper += factor * rows;
        std::memcpy(&rows, block.data() + 6 * column + 2, sizeof rows);
        lower += factor * rows;
    }
    const Four<Real> zero{};
    return {{__builtin_shufflevector(upper, zero, 0, 1, 2, 4)}, {__builtin_shufflevector(lower, zero, 1, 2, 3, 4)}};
}
template <typename Real>
KILN_INLINE Freedoms<Real, 3> operator*(const Eigen::Matrix<Real, 6, 6>& block, const Freedoms<Real, 3>& a) {
    const Four<Real>* from = &a.u.x;
    Freedoms<Real, 3> product;
    Four<Real>* to = &product.u.x;
    for (int row = 0; row < 6; ++row) {
        Four<Real> sum = block.data()[row] * from[0];
        for (int column = 1; column < 6; ++column) sum += block.data()[6 * column + row] * from[column];
        to[row] = sum;
    }
    return product;
}

template <typename Real>
KILN_INLINE Four<Real> turned(const Four<Real>& a) { return __builtin_shufflevector(a, a, 1, 2, 0, 3); }

/// A vector that all fields share, as products with arrows need it.
template <typename Real, int width>
struct Arm;

template <typename Real>
struct Arm<Real, 1> {
    Four<Real> axes;

    KILN_INLINE explicit Arm(const Real* arm) : axes{arm[0], arm[1], arm[2], Real{0}} {}

    KILN_INLINE Arrow<Real, 1> cross(const Arrow<Real, 1>& b) const {
        return {turned<Real>(axes * turned<Real>(b.axes) - turned<Real>(axes) * b.axes)};
    }
    /// stiffness a + more (arm . a) arm
    KILN_INLINE Arrow<Real, 1> stretched(Real stiffness, Real more, const Arrow<Real, 1>& a) const {
        const Four<Real> product = axes * a.axes;
        const Four<Real> pairs = product + __builtin_shufflevector(product, product, 1, 0, 3, 2);
        const Four<Real> dot = pairs + __builtin_shufflevector(pairs, pairs, 2, 3, 0, 1);
        return {stiffness * a.axes + (more * dot) * axes};
    }
};

template <typename Real>
struct Arm<Real, 3> {
    Real x, y, z;

    KILN_INLINE explicit Arm(const Real* arm) : x(arm[0]), y(arm[1]), z(arm[2]) {}

    KILN_INLINE Arrow<Real, 3> cross(const Arrow<Real, 3>& b) const {
        return {y * b.z - z * b.y, z * b.x - x * b.z, x * b.y - y * b.x};
    }
    KILN_INLINE Arrow<Real, 3> stretched(Real stiffness, Real more, const Arrow<Real, 3>& a) const {
        const Four<Real> dot = more * (x * a.x + y * a.y + z * a.z);
        return {stiffness * a.x + x * dot, stiffness * a.y + y * dot, stiffness * a.z + z * dot};
    }
};

/// Adds what holds the nodes of a spring in their motions: minus what the spring does to them. Both sums may be the same.
template <typename Real, int width>
KILN_INLINE void add_force(const Spring<Real>& spring, const Freedoms<Real, width>& first, const Freedoms<Real, width>& second,
                           Freedoms<Real, width>& on_first, Freedoms<Real, width>& on_second) {
    const Arm<Real, width> arm(spring.arm);
    const auto force = arm.stretched(spring.shear, spring.axial, second.u - first.u + arm.cross(first.q + second.q));
    const auto moment = arm.stretched(spring.bending, spring.twisting, second.q - first.q);
    const auto about = arm.cross(force);  // both ends
    on_first.u = on_first.u - force;
    on_first.q = on_first.q - about - moment;
    on_second.u = on_second.u + force;
    on_second.q = on_second.q - about + moment;
}

/// Blocks of a spring for its nodes: as add_force, one column for each freedom.
struct SpringBlocks {
    Mat6 ii, ij, jj;
};

SpringBlocks blocks_of(const Spring<double>& spring);

}  // namespace kiln::linalg
