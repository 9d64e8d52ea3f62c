// quad.h: vectors of x, y, z and a spare place in single precision, which processors add and multiply as one.
#pragma once

#include <cstring>

#include "core/state.h"

namespace kiln::sintering {

struct Quad {
    using Lanes = float __attribute__((vector_size(16)));
    Lanes lanes{};
};

/// The same in double precision, for sums.
struct WideQuad {
    using Lanes = double __attribute__((vector_size(32)));
    Lanes lanes{};

    double sum() const { return lanes[0] + lanes[1] + lanes[2] + lanes[3]; }
    Vec3 vector() const { return {lanes[0], lanes[1], lanes[2]}; }
};

inline Quad operator+(Quad a, Quad b) { return {a.lanes + b.lanes}; }
inline Quad operator-(Quad a, Quad b) { return {a.lanes - b.lanes}; }
inline Quad operator*(Quad a, Quad b) { return {a.lanes * b.lanes}; }
inline Quad operator*(float a, Quad b) { return {a * b.lanes}; }
inline Quad& operator+=(Quad& a, Quad b) { return a = a + b; }
inline Quad& operator-=(Quad& a, Quad b) { return a = a - b; }

inline Quad quad(double x, double y, double z) {
    return {Quad::Lanes{static_cast<float>(x), static_cast<float>(y), static_cast<float>(z), 0.0F}};
}
inline Quad quad(const Vec3& v) { return quad(v[0], v[1], v[2]); }

/// Four neighbours in memory, at any address.
inline Quad load(const float* from) {
    Quad a;
    std::memcpy(&a.lanes, from, sizeof a.lanes);
    return a;
}

/// One place of a vector in all four.
template <int place>
Quad all(Quad a) {
    return {__builtin_shufflevector(a.lanes, a.lanes, place, place, place, place)};
}

/// The sum of all four places in each of them.
inline Quad sum(Quad a) {
    a.lanes += __builtin_shufflevector(a.lanes, a.lanes, 1, 0, 3, 2);
    a.lanes += __builtin_shufflevector(a.lanes, a.lanes, 2, 3, 0, 1);
    return a;
}

/// Scalar products of three vectors with v, in x, y and z.
inline Quad transposed_product(Quad a, Quad b, Quad c, Quad v) {
    const Quad::Lanes low = __builtin_shufflevector(a.lanes, b.lanes, 0, 4, 1, 5),
                      high = __builtin_shufflevector(a.lanes, b.lanes, 2, 6, 3, 7);
    const Quad x{__builtin_shufflevector(low, c.lanes, 0, 1, 4, 7)}, y{__builtin_shufflevector(low, c.lanes, 2, 3, 5, 7)};
    const Quad z{__builtin_shufflevector(high, c.lanes, 0, 1, 6, 7)};
    return x * all<0>(v) + y * all<1>(v) + z * all<2>(v);
}

/// x, y, z with nothing in the spare place.
inline Quad only_vector(Quad a) { return {__builtin_shufflevector(a.lanes, Quad::Lanes{}, 0, 1, 2, 7)}; }

/// sums += a * b, place by place.
inline void add_product(Quad a, Quad b, WideQuad& sums) {
    sums.lanes += __builtin_convertvector(a.lanes, WideQuad::Lanes) * __builtin_convertvector(b.lanes, WideQuad::Lanes);
}

}  // namespace kiln::sintering
