// element.h: forces of a trilinear hexahedron on its nodes, in sums and differences of its nodal values.
//
// A nodal value u0, u1 along one axis gives the sum S = u0 + u1 and the difference D = u1 - u0; the field is (S + D eta)/2 for eta
// from -1 to 1. On an edge of length h the integral of u v is h/4 (S S' + D D'/3), that of u' v' is D D'/h, that of u' v is D
// S'/2. In three dimensions they multiply. Mode m of a component: bit 0 says D along x, bit 1 D along y, bit 2 D along z.
#pragma once

#include <array>

#include "linalg/fourier_inverse.h"

namespace kiln::voxel {

/// Numbers of an element of the given edges: products of a mode with itself, and of modes of two components with each other.
template <typename Number>
struct ElementIntegrals {
    static constexpr std::size_t modes = 8;

    explicit ElementIntegrals(const std::array<double, 3>& edge) {
        for (std::size_t mode = 0; mode < modes; ++mode) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                double product = mode >> axis & 1 ? 1.0 / edge[axis] : 0.0;
                for (std::size_t other = 0; other < 3; ++other)
                    if (other != axis) product *= mass(mode, other, edge[other]);
                slope[axis][mode] = Number{} + static_cast<Scalar>(product);
            }
        }
        for (std::size_t axis = 0; axis < 3; ++axis)
            for (std::size_t bit = 0; bit < 2; ++bit)
                cross[axis][bit] = Number{} + static_cast<Scalar>(0.25 * mass(bit << axis, axis, edge[axis]));
    }

    using Scalar = std::remove_cvref_t<decltype(std::declval<Number>()[0])>;

    Number slope[3][modes];  // [axis][mode]: integral of the square of the derivative along the axis
    Number cross[3][2];      // [axis][D along it]: of the derivative along the one other axis times that along the other

   private:
    static double mass(std::size_t mode, std::size_t axis, double edge) { return mode >> axis & 1 ? edge / 12.0 : edge / 4.0; }
};

/// Forces of the modes u of a conductor.
template <typename Number>
[[gnu::always_inline]] inline void element_forces(const ElementIntegrals<Number>& integrals, const Number (&u)[1][8],
                                                  const Number& conductivity, const Number&, Number (&force)[1][8]) {
    force[0][0] = Number{};
#pragma GCC unroll 8
    for (std::size_t mode = 1; mode < 8; ++mode)
        force[0][mode] =
            conductivity * (integrals.slope[0][mode] + integrals.slope[1][mode] + integrals.slope[2][mode]) * u[0][mode];
}

/// The same of an elastic solid: the energy is lambda/2 (div u)^2 + shear/2 (grad u : grad u + grad u : (grad u)^T).
template <typename Number>
[[gnu::always_inline]] inline void element_forces(const ElementIntegrals<Number>& integrals, const Number (&u)[3][8],
                                                  const Number& lambda, const Number& shear, Number (&force)[3][8]) {
    const Number sum = lambda + shear;
#pragma GCC unroll 3
    for (std::size_t c = 0; c < 3; ++c) {
        force[c][0] = Number{};
#pragma GCC unroll 8
        for (std::size_t mode = 1; mode < 8; ++mode) {
            const Number all = integrals.slope[0][mode] + integrals.slope[1][mode] + integrals.slope[2][mode];
            force[c][mode] = shear * all * u[c][mode];
            if (mode >> c & 1) force[c][mode] += sum * integrals.slope[c][mode] * u[c][mode];
        }
    }
    // lambda d_a u_a d_b u_b + shear d_b u_a d_a u_b for each two axes a, b, and D or S along the third, t.
#pragma GCC unroll 3
    for (std::size_t t = 0; t < 3; ++t) {
        const std::size_t a = (t + 1) % 3, b = (t + 2) % 3;
#pragma GCC unroll 2
        for (std::size_t bit = 0; bit < 2; ++bit) {
            const std::size_t along_a = (std::size_t{1} << a) | (bit << t), along_b = (std::size_t{1} << b) | (bit << t);
            const Number by_lambda = lambda * integrals.cross[t][bit], by_shear = shear * integrals.cross[t][bit];
            force[a][along_a] += by_lambda * u[b][along_b];
            force[b][along_b] += by_lambda * u[a][along_a];
            force[a][along_b] += by_shear * u[b][along_a];
            force[b][along_a] += by_shear * u[a][along_b];
        }
    }
}

}  // namespace kiln::voxel
