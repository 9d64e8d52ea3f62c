// quad.h: vectors of x, y, z and a spare place, which processors add and multiply as one; in single or double precision.
#pragma once

#include <cstring>

#include "core/types.h"

// Four doubles need 32 bytes; how they would be handed over between objects of different compilers does not matter here.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace kiln::linalg {

// Aligned to 16 bytes whatever the registers: code for those of 32 bytes would else take vectors to be aligned to all of theirs.
template <typename Real>
struct Quad {
    using Lanes [[gnu::vector_size(4 * sizeof(Real)), gnu::aligned(16)]] = Real;
    Lanes lanes{};
};

/// The same in double precision, for sums.
struct WideQuad {
    using Lanes [[gnu::vector_size(32), gnu::aligned(16)]] = double;
    Lanes lanes{};

    double sum() const { return lanes[0] + lanes[1] + lanes[2] + lanes[3]; }
    Vec3 vector() const { return {lanes[0], lanes[1], lanes[2]}; }
};

inline WideQuad wide_quad(double x, double y, double z) { return {WideQuad::Lanes{x, y, z, 0.0}}; }

template <typename Real>
Quad<Real> operator+(Quad<Real> a, Quad<Real> b) { return {a.lanes + b.lanes}; }
template <typename Real>
Quad<Real> operator-(Quad<Real> a, Quad<Real> b) { return {a.lanes - b.lanes}; }
template <typename Real>
Quad<Real> operator*(Quad<Real> a, Quad<Real> b) { return {a.lanes * b.lanes}; }
template <typename Real>
Quad<Real> operator*(Real a, Quad<Real> b) { return {a * b.lanes}; }
template <typename Real>
Quad<Real>& operator+=(Quad<Real>& a, Quad<Real> b) { return a = a + b; }
template <typename Real>
Quad<Real>& operator-=(Quad<Real>& a, Quad<Real> b) { return a = a - b; }

template <typename Real>
Quad<Real> quad(double x, double y, double z) {
    return {typename Quad<Real>::Lanes{static_cast<Real>(x), static_cast<Real>(y), static_cast<Real>(z), Real{0}}};
}
template <typename Real>
Quad<Real> quad(const Vec3& v) { return quad<Real>(v[0], v[1], v[2]); }

/// x, y and z.
template <typename Real>
Vec3 vector(Quad<Real> a) { return Vec3(a.lanes[0], a.lanes[1], a.lanes[2]); }

template <typename Real>
Quad<double> in_double(Quad<Real> a) { return {__builtin_convertvector(a.lanes, Quad<double>::Lanes)}; }

/// Four neighbours in memory, at any address.
template <typename Real>
Quad<Real> load(const Real* from) {
    Quad<Real> a;
    std::memcpy(&a.lanes, from, sizeof a.lanes);
    return a;
}

/// One place of a vector in all four.
template <int place, typename Real>
Quad<Real> all(Quad<Real> a) {
    return {__builtin_shufflevector(a.lanes, a.lanes, place, place, place, place)};
}

/// The sum of all four places in each of them.
template <typename Real>
Quad<Real> sum(Quad<Real> a) {
    a.lanes += __builtin_shufflevector(a.lanes, a.lanes, 1, 0, 3, 2);
    a.lanes += __builtin_shufflevector(a.lanes, a.lanes, 2, 3, 0, 1);
    return a;
}

/// x, y and z in another order, the spare place as it is.
template <int x, int y, int z, typename Real>
Quad<Real> in_order(Quad<Real> a) {
    return {__builtin_shufflevector(a.lanes, a.lanes, x, y, z, 3)};
}

/// x, y, z with nothing in the spare place.
template <typename Real>
Quad<Real> only_vector(Quad<Real> a) {
    return {__builtin_shufflevector(a.lanes, typename Quad<Real>::Lanes{}, 0, 1, 2, 7)};
}

/// A symmetric 3x3 block; spare places are zero.
template <typename Real>
struct SymmetricBlock {
    Quad<Real> diagonal, off;  // xx, yy, zz; yz, zx, xy

    SymmetricBlock() = default;
    template <typename Matrix>
    explicit SymmetricBlock(const Matrix& m)
        : diagonal(quad<Real>(m(0, 0), m(1, 1), m(2, 2))), off(quad<Real>(m(2, 1), m(2, 0), m(1, 0))) {}

    template <typename Other>
    explicit SymmetricBlock(const SymmetricBlock<Other>& other)
        : diagonal{__builtin_convertvector(other.diagonal.lanes, typename Quad<Real>::Lanes)},
          off{__builtin_convertvector(other.off.lanes, typename Quad<Real>::Lanes)} {}

    Eigen::Matrix3d matrix() const {
        Eigen::Matrix3d m = vector(diagonal).asDiagonal();
        m(1, 2) = m(2, 1) = static_cast<double>(off.lanes[0]);
        m(0, 2) = m(2, 0) = static_cast<double>(off.lanes[1]);
        m(0, 1) = m(1, 0) = static_cast<double>(off.lanes[2]);
        return m;
    }

    friend Quad<Real> operator*(const SymmetricBlock& m, Quad<Real> v) {
        return m.diagonal * v + in_order<2, 0, 1>(m.off) * in_order<1, 2, 0>(v) + in_order<1, 2, 0>(m.off) * in_order<2, 0, 1>(v);
    }
};

/// sums += a * b, place by place; products are rounded as Real, sums are not.
template <typename Real>
void add_product(Quad<Real> a, Quad<Real> b, WideQuad& sums) {
    sums.lanes += __builtin_convertvector(a.lanes * b.lanes, WideQuad::Lanes);
}

}  // namespace kiln::linalg
