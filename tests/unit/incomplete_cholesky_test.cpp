// incomplete_cholesky_test.cpp: the preconditioner of sintering stays positive definite, and its diagonal blocks never break down.
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
using linalg::EdgeStiffness;

namespace {

/// Springs between random nodes, each stiff along its own direction and soft across it, and one outer node that holds all a little.
struct RandomNetwork {
    std::size_t nodes;
    std::vector<std::int32_t> first, second;
    std::vector<Vec3> direction;
    std::vector<double> along, across;
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
                add(i, j, n, stiffness, 1e-4 * stiffness);
            }
        const std::size_t inside = first.size();
        for (std::size_t i = 0; i < nodes; ++i) add(i, nodes, Vec3::UnitX(), 1e-3, 1e-3);
        range = {0, nodes, 0, inside, first.size()};
    }

    void add(std::size_t i, std::size_t j, const Vec3& n, double normal, double tangential) {
        first.push_back(static_cast<std::int32_t>(i));
        second.push_back(static_cast<std::int32_t>(j));
        direction.push_back(n);
        along.push_back(normal);
        across.push_back(tangential);
    }

    template <typename Real>
    EdgeStiffness<Real> springs() const {
        EdgeStiffness<Real> springs(first.size());
        for (std::size_t edge = 0; edge < first.size(); ++edge) {
            springs.set_direction(edge, direction[edge]);
            springs.set(edge, along[edge], across[edge]);
        }
        return springs;
    }
};

/// M^-1, column by column.
Eigen::MatrixXd inverse_of(const RandomNetwork& network) {
    const EdgeStiffness<double> springs = network.springs<double>();
    IncompleteCholesky<double> factor(network.nodes + 1, std::span(&network.range, 1), network.first, network.second, springs);
    factor.factorise(network.range);
    const auto size = static_cast<Eigen::Index>(3 * network.nodes);
    Eigen::MatrixXd inverse(size, size);
    std::vector<Quad<double>> r(network.nodes + 1), z(network.nodes + 1);
    for (Eigen::Index column = 0; column < size; ++column) {
        std::fill(r.begin(), r.end(), Quad<double>{});
        r[static_cast<std::size_t>(column / 3)] = linalg::quad<double>(Vec3::Unit(column % 3));
        factor.apply(network.range, r.data(), z.data());
        for (std::size_t node = 0; node < network.nodes; ++node)
            inverse.col(column).segment<3>(static_cast<Eigen::Index>(3 * node)) = linalg::vector(z[node]);
    }
    return inverse;
}

/// r . M^-1 r as the iteration of sintering finds it, after half of the solve.
template <typename Real>
double seen_of(const IncompleteCholesky<Real>& factor, const RandomNetwork& network, const Eigen::VectorXd& r) {
    linalg::WideQuad seen;
    std::vector<Quad<Real>> sums(network.nodes);
    factor.forward(network.range, sums.data(), [&](std::size_t node, Quad<Real> sum) {
        const Quad<Real> left = sum + linalg::quad<Real>(Vec3(r.segment<3>(static_cast<Eigen::Index>(3 * node))));
        linalg::add_product(left, factor.inverse(node) * left, seen);
        return factor.inverse(node) * left;
    });
    return seen.sum();
}

}  // namespace

TEST_CASE("incomplete factors of stiff and soft springs: M is symmetric and positive definite") {
    for (unsigned seed = 1; seed <= 40; ++seed) {
        CAPTURE(seed);
        const Eigen::MatrixXd inverse = inverse_of(RandomNetwork(25, seed));
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(0.5 * (inverse + inverse.transpose()));
        const double largest = modes.eigenvalues().maxCoeff();
        const double rounding = std::sqrt(std::numeric_limits<double>::epsilon());  // small pivots let it grow
        CHECK((inverse - inverse.transpose()).cwiseAbs().maxCoeff() < rounding * largest);
        CHECK(modes.eigenvalues().minCoeff() > 2e-8 * largest);
    }
}

TEST_CASE_TEMPLATE("the iteration sees every residual, in either precision", Real, float, double) {
    for (unsigned seed = 1; seed <= 40; ++seed) {
        CAPTURE(seed);
        const RandomNetwork network(25, seed);
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(inverse_of(network));
        const EdgeStiffness<Real> springs = network.springs<Real>();
        IncompleteCholesky<Real> factor(network.nodes + 1, std::span(&network.range, 1), network.first, network.second, springs);
        factor.factorise(network.range);
        for (Eigen::Index mode = 0; mode < modes.eigenvalues().size(); ++mode) {
            const double seen = seen_of(factor, network, modes.eigenvectors().col(mode));
            CHECK(seen > 0.5 * modes.eigenvalues()[mode]);
            CHECK(seen < 2.0 * modes.eigenvalues()[mode]);
        }
    }
}

TEST_CASE("what elimination leaves of a node holds it at least as its springs to later nodes and to outer ones do") {
    for (unsigned seed = 1; seed <= 40; ++seed) {
        CAPTURE(seed);
        const RandomNetwork network(25, seed);
        const EdgeStiffness<double> springs = network.springs<double>();
        IncompleteCholesky<double> factor(network.nodes + 1, std::span(&network.range, 1), network.first, network.second, springs);
        factor.factorise(network.range);
        std::vector<Eigen::Matrix3d> later(network.nodes + 1, Eigen::Matrix3d::Zero());
        for (std::size_t edge = 0; edge < network.first.size(); ++edge)
            later[static_cast<std::size_t>(network.first[edge])] += springs.spring(edge).block();
        for (std::size_t node = 0; node < network.nodes; ++node) {
            const Eigen::Matrix3d left = factor.inverse(node).matrix().inverse();
            const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> modes(left - later[node]);
            const double rounding = 1e-9;  // of an inverse whose condition is 1e6 and more
            CHECK(modes.eigenvalues().minCoeff() > -rounding * factor.diagonal(node).matrix().trace());
        }
    }
}

TEST_CASE("springs along a triangle of nodes: blocks of the factorisation by hand") {
    // kn = kt = 1: scalars. Nodes 0, 1, 2: D0 = 2, D1 = 2 - 1/2, D2 = 2 - 1/2 - 1/1.5.
    const std::vector<std::int32_t> first{0, 0, 1}, second{1, 2, 2};
    EdgeStiffness<double> springs(3);
    for (std::size_t edge = 0; edge < 3; ++edge) {
        springs.set_direction(edge, Vec3::UnitZ());
        springs.set(edge, 1.0, 1.0);
    }
    const NodeRange range{0, 3, 0, 3, 3};
    IncompleteCholesky<double> factor(3, std::span(&range, 1), first, second, springs);
    factor.factorise(range);
    CHECK(factor.diagonal(2).matrix().isApprox(Eigen::Matrix3d(2.0 * Eigen::Matrix3d::Identity())));
    CHECK(factor.inverse(0).matrix().isApprox(Eigen::Matrix3d(Eigen::Matrix3d::Identity() / 2.0)));
    CHECK(factor.inverse(1).matrix().isApprox(Eigen::Matrix3d(Eigen::Matrix3d::Identity() / 1.5)));
    CHECK(factor.inverse(2).matrix().isApprox(Eigen::Matrix3d(Eigen::Matrix3d::Identity() / (1.5 - 1.0 / 1.5))));
}

TEST_CASE("the inverse of a pivot: what was there before where it is negative, zero of rounding, no number of none") {
    const auto inverse_of_diagonal = [](double x, double y, double z) {
        return linalg::pivot_inverse(Vec3(x, y, z).asDiagonal(), Vec3(4.0, 3.0, 2.0).asDiagonal(), 1e-14);
    };
    CHECK(inverse_of_diagonal(-1e-3, -1e-16, 0.5).isApprox(Eigen::Matrix3d(Vec3(0.25, 0.0, 2.0).asDiagonal())));
    CHECK(inverse_of_diagonal(4.0, 3.0, 2.0).isApprox(Eigen::Matrix3d(Vec3(0.25, 1.0 / 3.0, 0.5).asDiagonal())));
    const Eigen::Matrix3d none = Eigen::Matrix3d::Constant(std::nan(""));
    CHECK_FALSE(linalg::pivot_inverse(none, none, 1e-14).allFinite());
}
