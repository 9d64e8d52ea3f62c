// quad.h: vectors of x, y, z and a spare place, which processors add and multiply as one; in single or double precision.
#pragma once

#include <cstring>

#include "core/types.h"

// Four doubles need 32 bytes; how they would be handed over between objects of different compilers does not matter here.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace kiln::linalg {

template <typename Real>
struct Quad {
    using Lanes [[gnu::vector_size(4 * sizeof(Real))]] = Real;
    Lanes lanes{};
};

/// The same in double precision, for sums.
struct WideQuad {
    using Lanes [[gnu::vector_size(32)]] = double;
    Lanes lanes{};

    double sum() const { return lanes[0] + lanes[1] + lanes[2] + lanes[3]; }
    Vec3 vector() const { return {lanes[0], lanes[1], lanes[2]}; }
};

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

/// Scalar products of three vectors with v, in x, y and z.
template <typename Real>
Quad<Real> transposed_product(Quad<Real> a, Quad<Real> b, Quad<Real> c, Quad<Real> v) {
    using Lanes = typename Quad<Real>::Lanes;
    const Lanes low = __builtin_shufflevector(a.lanes, b.lanes, 0, 4, 1, 5),
                high = __builtin_shufflevector(a.lanes, b.lanes, 2, 6, 3, 7);
    const Quad<Real> x{__builtin_shufflevector(low, c.lanes, 0, 1, 4, 7)}, y{__builtin_shufflevector(low, c.lanes, 2, 3, 5, 7)};
    const Quad<Real> z{__builtin_shufflevector(high, c.lanes, 0, 1, 6, 7)};
    return x * all<0>(v) + y * all<1>(v) + z * all<2>(v);
}

/// x, y, z with nothing in the spare place.
template <typename Real>
Quad<Real> only_vector(Quad<Real> a) {
    return {__builtin_shufflevector(a.lanes, typename Quad<Real>::Lanes{}, 0, 1, 2, 7)};
}

/// sums += a * b, place by place.
template <typename Real>
void add_product(Quad<Real> a, Quad<Real> b, WideQuad& sums) {
    sums.lanes += __builtin_convertvector(a.lanes, WideQuad::Lanes) * __builtin_convertvector(b.lanes, WideQuad::Lanes);
}

}  // namespace kiln::linalg
