// incomplete_cholesky_test.cpp: the preconditioner of sintering stays positive definite where fill that is left out spoils pivots.
#include "linalg/incomplete_cholesky.h"

#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <random>

using namespace kiln;
using linalg::IncompleteCholesky;
using linalg::NodeRange;
using linalg::Quad;

namespace {

/// Springs between random nodes, each stiff along its own direction and soft across it, and one outer node that holds all a little.
struct RandomNetwork {
    std::size_t nodes;
    std::vector<std::int32_t> first, second;
    std::vector<Eigen::Matrix3d> block;
    NodeRange range;

    RandomNetwork(std::size_t count, unsigned seed) : nodes(count) {
        std::mt19937 random(seed);
        std::uniform_real_distribution<double> uniform(-1.0, 1.0), exponent(-2.0, 2.0);
        std::vector<Vec3> place;
        for (std::size_t i = 0; i < nodes; ++i) place.emplace_back(uniform(random), uniform(random), uniform(random));
        for (std::size_t i = 0; i < nodes; ++i)
            for (std::size_t j = i + 1; j < nodes; ++j) {
                const Vec3 vector = place[j] - place[i];
                if (vector.norm() > 0.8) continue;
                const Vec3 n = vector.normalized();
                const double stiffness = std::pow(10.0, exponent(random));
                add(i, j, stiffness * (n * n.transpose() + 1e-4 * Eigen::Matrix3d::Identity()));
            }
        const std::size_t inside = first.size();
        for (std::size_t i = 0; i < nodes; ++i) add(i, nodes, 1e-3 * Eigen::Matrix3d::Identity());
        range = {0, nodes, 0, inside, first.size()};
    }

    void add(std::size_t i, std::size_t j, const Eigen::Matrix3d& stiffness) {
        first.push_back(static_cast<std::int32_t>(i));
        second.push_back(static_cast<std::int32_t>(j));
        block.push_back(stiffness);
    }
};

/// M^-1, column by column.
template <typename Real>
Eigen::MatrixXd inverse_of(const RandomNetwork& network) {
    IncompleteCholesky<Real> factor(network.nodes + 1, std::span(&network.range, 1), network.first, network.second);
    factor.factorise(network.range, [&](std::size_t edge) { return network.block[edge]; });
    const auto size = static_cast<Eigen::Index>(3 * network.nodes);
    Eigen::MatrixXd inverse(size, size);
    std::vector<Quad<Real>> r(network.nodes + 1), z(network.nodes + 1);
    for (Eigen::Index column = 0; column < size; ++column) {
        std::fill(r.begin(), r.end(), Quad<Real>{});
        r[static_cast<std::size_t>(column / 3)] = linalg::quad<Real>(Vec3::Unit(column % 3));
        factor.apply(network.range, r.data(), z.data());
        for (std::size_t node = 0; node < network.nodes; ++node)
            inverse.col(column).segment<3>(static_cast<Eigen::Index>(3 * node)) = linalg::vector(z[node]);
    }
    return inverse;
}

}  // namespace

TEST_CASE_TEMPLATE("incomplete factors of stiff and soft springs see every residual: M is positive definite", Real, float, double) {
    for (unsigned seed = 1; seed <= 40; ++seed) {
        CAPTURE(seed);
        const Eigen::MatrixXd inverse = inverse_of<Real>(RandomNetwork(25, seed));
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(0.5 * (inverse + inverse.transpose()));
        const double largest = modes.eigenvalues().maxCoeff();
        const double rounding = std::sqrt(std::numeric_limits<Real>::epsilon());  // small pivots let it grow
        CHECK((inverse - inverse.transpose()).cwiseAbs().maxCoeff() < rounding * largest);
        CHECK(modes.eigenvalues().minCoeff() > 2e-8 * largest);
    }
}

TEST_CASE("the inverse of a pivot: none of a negative one, what was there before where it is hardly negative, zero of rounding") {
    const auto inverse_of_diagonal = [](double x, double y, double z) {
        return linalg::pivot_inverse(Vec3(x, y, z).asDiagonal(), Vec3(4.0, 3.0, 2.0).asDiagonal(), 1e-14);
    };
    CHECK_FALSE(inverse_of_diagonal(-1.0, 1e-16, 0.5));
    REQUIRE(inverse_of_diagonal(-1e-3, -1e-16, 0.5));
    CHECK(inverse_of_diagonal(-1e-3, -1e-16, 0.5)->isApprox(Eigen::Matrix3d(Vec3(0.25, 0.0, 2.0).asDiagonal())));
}
