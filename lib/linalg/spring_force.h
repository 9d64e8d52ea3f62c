// spring_force.h: what a spring between two nodes with six freedoms does to them, in vectors of four numbers: the axes of one
// field, or one component of three fields; displacements and rotations side by side in vectors of eight where registers hold them.
#pragma once

#include <cstddef>
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
struct Freedoms;

template <typename Real>
struct alignas(8 * sizeof(Real)) Freedoms<Real, 1> {  // no register crosses a line of the cache
    Four<Real> axes[2];                               // of displacement and of rotation

    static constexpr int size = 8;
    /// Where a component of a field stands.
    static constexpr int place(int component, int) { return component + (component > 2 ? 1 : 0); }
    Real* data() { return reinterpret_cast<Real*>(this); }
    const Real* data() const { return reinterpret_cast<const Real*>(this); }

    static Freedoms of(const Arrow<Real, 1>& u, const Arrow<Real, 1>& q) { return {{u.axes, q.axes}}; }
    Arrow<Real, 1> u() const { return {axes[0]}; }
    Arrow<Real, 1> q() const { return {axes[1]}; }
};

template <typename Real>
struct alignas(8 * sizeof(Real)) Freedoms<Real, 3> {
    Four<Real> x[2], y[2], z[2];  // displacement, rotation

    static constexpr int size = 24;
    static constexpr int place(int component, int field) { return 8 * (component % 3) + 4 * (component / 3) + field; }
    Real* data() { return reinterpret_cast<Real*>(this); }
    const Real* data() const { return reinterpret_cast<const Real*>(this); }

    static Freedoms of(const Arrow<Real, 3>& u, const Arrow<Real, 3>& q) { return {{u.x, q.x}, {u.y, q.y}, {u.z, q.z}}; }
    Arrow<Real, 3> u() const { return {x[0], y[0], z[0]}; }
    Arrow<Real, 3> q() const { return {x[1], y[1], z[1]}; }
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

/// Four numbers, the vth of a node's motion or of the forces at it.
template <typename Real, int width>
KILN_INLINE Four<Real>& four(Freedoms<Real, width>& a, int v) { return reinterpret_cast<Four<Real>*>(&a)[v]; }
template <typename Real, int width>
KILN_INLINE const Four<Real>& four(const Freedoms<Real, width>& a, int v) { return reinterpret_cast<const Four<Real>*>(&a)[v]; }

template <typename Real, int width>
KILN_INLINE Freedoms<Real, width> operator+(const Freedoms<Real, width>& a, const Freedoms<Real, width>& b) {
    Freedoms<Real, width> sum;
    for (int v = 0; v < sum.size / 4; ++v) four(sum, v) = four(a, v) + four(b, v);
    return sum;
}
template <typename Real, int width>
KILN_INLINE Freedoms<Real, width> operator-(const Freedoms<Real, width>& a, const Freedoms<Real, width>& b) {
    Freedoms<Real, width> difference;
    for (int v = 0; v < difference.size / 4; ++v) four(difference, v) = four(a, v) - four(b, v);
    return difference;
}
template <typename Real, int width>
KILN_INLINE Freedoms<Real, width> operator*(std::type_identity_t<Real> factor, const Freedoms<Real, width>& a) {
    Freedoms<Real, width> product;
    for (int v = 0; v < product.size / 4; ++v) four(product, v) = factor * four(a, v);
    return product;
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
    return {{__builtin_shufflevector(upper, zero, 0, 1, 2, 4), __builtin_shufflevector(lower, zero, 1, 2, 3, 4)}};
}
template <typename Real>
KILN_INLINE Freedoms<Real, 3> operator*(const Eigen::Matrix<Real, 6, 6>& block, const Freedoms<Real, 3>& a) {
    const auto place = [](int component) { return Freedoms<Real, 3>::place(component, 0) / 4; };
    Freedoms<Real, 3> product;
    for (int row = 0; row < 6; ++row) {
        Four<Real> sum = block.data()[row] * four(a, 0);
        for (int column = 1; column < 6; ++column) sum += block.data()[6 * column + row] * four(a, place(column));
        four(product, place(row)) = sum;
    }
    return product;
}

/// Shear, axial, bending and twisting.
template <typename Real>
KILN_INLINE Four<Real> stiffness_of(const Spring<Real>& spring) {
    Four<Real> stiffness;
    std::memcpy(&stiffness, reinterpret_cast<const char*>(&spring) + offsetof(Spring<Real>, shear), sizeof stiffness);
    return stiffness;
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
    KILN_INLINE explicit Arm(const Spring<Real>& spring) {
        std::memcpy(&axes, reinterpret_cast<const char*>(&spring) + offsetof(Spring<Real>, arm), sizeof axes);
        axes = __builtin_shufflevector(axes, Four<Real>{}, 0, 1, 2, 4);
    }

    KILN_INLINE Arrow<Real, 1> cross(const Arrow<Real, 1>& b) const {
        return {turned<Real>(axes * turned<Real>(b.axes) - turned<Real>(axes) * b.axes)};
    }
};

template <typename Real>
struct Arm<Real, 3> {
    Real x, y, z;

    KILN_INLINE explicit Arm(const Real* arm) : x(arm[0]), y(arm[1]), z(arm[2]) {}
    KILN_INLINE explicit Arm(const Spring<Real>& spring) : Arm(spring.arm) {}

    KILN_INLINE Arrow<Real, 3> cross(const Arrow<Real, 3>& b) const {
        return {y * b.z - z * b.y, z * b.x - x * b.z, x * b.y - y * b.x};
    }
};

/// Four numbers of a displacement and four of a rotation, or of a force and a moment, in two registers or in one of 32 bytes.
template <typename Real, bool one_register>
struct Twin {
    Four<Real> u, q;

    KILN_INLINE static Twin load(const Four<Real>* from) { return {from[0], from[1]}; }
    KILN_INLINE void store(Four<Real>* to) const {
        to[0] = u;
        to[1] = q;
    }
    /// Two of four numbers, each in four places.
    template <int of_u, int of_q>
    KILN_INLINE static Twin pick(const Four<Real>& a) {
        return {__builtin_shufflevector(a, a, of_u, of_u, of_u, of_u), __builtin_shufflevector(a, a, of_q, of_q, of_q, of_q)};
    }
    KILN_INLINE static Twin twice(const Four<Real>& a) { return {a, a}; }
    KILN_INLINE Four<Real> upper() const { return q; }
    KILN_INLINE Four<Real> lower() const { return u; }
    KILN_INLINE Twin plus_lower(const Four<Real>& a) const { return {u + a, q}; }
    KILN_INLINE Twin plus_upper(const Four<Real>& a) const { return {u, q + a}; }
    KILN_INLINE Twin minus_upper(const Four<Real>& a) const { return {u, q - a}; }
    /// The sum of each four, in all places.
    KILN_INLINE Twin sums() const { return {sum(u), sum(q)}; }

    KILN_INLINE friend Twin operator+(const Twin& a, const Twin& b) { return {a.u + b.u, a.q + b.q}; }
    KILN_INLINE friend Twin operator-(const Twin& a, const Twin& b) { return {a.u - b.u, a.q - b.q}; }
    KILN_INLINE friend Twin operator*(const Twin& a, const Twin& b) { return {a.u * b.u, a.q * b.q}; }
    KILN_INLINE friend Twin operator*(Real factor, const Twin& b) { return {factor * b.u, factor * b.q}; }

   private:
    KILN_INLINE static Four<Real> sum(const Four<Real>& a) {
        const Four<Real> pairs = a + __builtin_shufflevector(a, a, 1, 0, 3, 2);
        return pairs + __builtin_shufflevector(pairs, pairs, 2, 3, 0, 1);
    }
};

/// Half of it is added to by adding zero to the other half, which may make a zero positive. No sum of forces can tell: sums begin
/// with a positive zero and so never become a negative one.
template <>
struct Twin<float, true> {
    using Eight [[gnu::vector_size(32)]] = float;
    Eight both;

    KILN_INLINE static Twin load(const Four<float>* from) {
        Twin twin;
        std::memcpy(&twin.both, from, sizeof twin.both);
        return twin;
    }
    KILN_INLINE void store(Four<float>* to) const { std::memcpy(to, &both, sizeof both); }
    template <int of_u, int of_q>
    KILN_INLINE static Twin pick(const Four<float>& a) {
        const Twin all = twice(a);
        return {__builtin_shufflevector(all.both, all.both, of_u, of_u, of_u, of_u, 4 + of_q, 4 + of_q, 4 + of_q, 4 + of_q)};
    }
    KILN_INLINE static Twin twice(const Four<float>& a) { return {__builtin_shufflevector(a, a, 0, 1, 2, 3, 0, 1, 2, 3)}; }
    KILN_INLINE Four<float> upper() const { return __builtin_shufflevector(both, both, 4, 5, 6, 7); }
    KILN_INLINE Four<float> lower() const { return __builtin_shufflevector(both, both, 0, 1, 2, 3); }
    KILN_INLINE Twin plus_lower(const Four<float>& a) const {
        return {both + __builtin_shufflevector(a, Four<float>{}, 0, 1, 2, 3, 4, 5, 6, 7)};
    }
    KILN_INLINE Twin plus_upper(const Four<float>& a) const {
        return {both + __builtin_shufflevector(Four<float>{}, a, 0, 1, 2, 3, 4, 5, 6, 7)};
    }
    KILN_INLINE Twin minus_upper(const Four<float>& a) const {
        return {both - __builtin_shufflevector(Four<float>{}, a, 0, 1, 2, 3, 4, 5, 6, 7)};
    }
    KILN_INLINE Twin sums() const {
        const Eight pairs = both + __builtin_shufflevector(both, both, 1, 0, 3, 2, 5, 4, 7, 6);
        return {pairs + __builtin_shufflevector(pairs, pairs, 2, 3, 0, 1, 6, 7, 4, 5)};
    }

    KILN_INLINE friend Twin operator+(const Twin& a, const Twin& b) { return {a.both + b.both}; }
    KILN_INLINE friend Twin operator-(const Twin& a, const Twin& b) { return {a.both - b.both}; }
    KILN_INLINE friend Twin operator*(const Twin& a, const Twin& b) { return {a.both * b.both}; }
    KILN_INLINE friend Twin operator*(float factor, const Twin& b) { return {factor * b.both}; }
};

/// Adds what holds the nodes of a spring in their motions: minus what the spring does to them. Both sums may be the same. Stretch
/// and turning yield force and moment by the same law.
template <bool one_register, typename Real>
KILN_INLINE void add_force(const Spring<Real>& spring, const Freedoms<Real, 1>& first, const Freedoms<Real, 1>& second,
                           Freedoms<Real, 1>& on_first, Freedoms<Real, 1>& on_second) {
    using Both = Twin<Real, one_register>;
    const Arm<Real, 1> arm(spring);
    const Both a = Both::load(first.axes), b = Both::load(second.axes), arms = Both::twice(arm.axes);
    const Both change = (b - a).plus_lower(arm.cross({(a + b).upper()}).axes);
    const Four<Real> k = stiffness_of(spring);
    const Both force = Both::template pick<0, 2>(k) * change + Both::template pick<1, 3>(k) * (arms * change).sums() * arms;
    const Four<Real> about = arm.cross({force.lower()}).axes;  // both ends
    (Both::load(on_first.axes) - force.plus_upper(about)).store(on_first.axes);
    (Both::load(on_second.axes) + force.minus_upper(about)).store(on_second.axes);
}

template <bool one_register, typename Real>
KILN_INLINE void add_force(const Spring<Real>& spring, const Freedoms<Real, 3>& first, const Freedoms<Real, 3>& second,
                           Freedoms<Real, 3>& on_first, Freedoms<Real, 3>& on_second) {
    using Both = Twin<Real, one_register>;
    const Arm<Real, 3> arm(spring);
    const Both ax = Both::load(first.x), ay = Both::load(first.y), az = Both::load(first.z);
    const Both bx = Both::load(second.x), by = Both::load(second.y), bz = Both::load(second.z);
    const Arrow<Real, 3> turning = arm.cross({(ax + bx).upper(), (ay + by).upper(), (az + bz).upper()});
    const Both x = (bx - ax).plus_lower(turning.x), y = (by - ay).plus_lower(turning.y), z = (bz - az).plus_lower(turning.z);
    const Four<Real> k = stiffness_of(spring);
    const Both stiffness = Both::template pick<0, 2>(k);
    const Both along = Both::template pick<1, 3>(k) * (arm.x * x + arm.y * y + arm.z * z);
    const Both fx = stiffness * x + arm.x * along, fy = stiffness * y + arm.y * along, fz = stiffness * z + arm.z * along;
    const Arrow<Real, 3> about = arm.cross({fx.lower(), fy.lower(), fz.lower()});
    (Both::load(on_first.x) - fx.plus_upper(about.x)).store(on_first.x);
    (Both::load(on_first.y) - fy.plus_upper(about.y)).store(on_first.y);
    (Both::load(on_first.z) - fz.plus_upper(about.z)).store(on_first.z);
    (Both::load(on_second.x) + fx.minus_upper(about.x)).store(on_second.x);
    (Both::load(on_second.y) + fy.minus_upper(about.y)).store(on_second.y);
    (Both::load(on_second.z) + fz.minus_upper(about.z)).store(on_second.z);
}

/// Blocks of a spring for its nodes: as add_force, one column for each freedom.
struct SpringBlocks {
    Mat6 ii, ij, jj;
};

SpringBlocks blocks_of(const Spring<double>& spring);

}  // namespace kiln::linalg
