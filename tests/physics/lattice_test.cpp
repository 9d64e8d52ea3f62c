// lattice_test.cpp: elastic constants of regular lattices of bonds against closed forms.
#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "core/parallel.h"
#include "mechanics/elastic_tensor.h"
#include "tests/physics/bonded_lattice.h"
#include "tests/physics/relative.h"

using namespace kiln;
using namespace kiln::mechanics;
using test::relative;

namespace {

const std::vector<Vec3> face_centred{{0.25, 0.25, 0.25}, {0.75, 0.75, 0.25}, {0.75, 0.25, 0.75}, {0.25, 0.75, 0.75}};

void check_cubic(const Mat6& stiffness, double c11, double c12, double c44) {
    for (int row = 0; row < 6; ++row) {
        for (int column = 0; column < 6; ++column) {
            const double expected = row == column ? (row < 3 ? c11 : c44) : (row < 3 && column < 3 ? c12 : 0.0);
            CHECK(std::abs(stiffness(row, column) - expected) <= 1e-6 * c11);
        }
    }
}

}  // namespace

TEST_CASE("simple cubic: C11 = kn/l, C12 = 0, C44 = kt/(2 l), also in a cell of one particle bonded to itself") {
    for (const int cells : {1, 2, 7}) {
        const State state = test::make_lattice({.cells = {cells, cells, cells}});
        const BondedBody body = bonded_body(state, {});
        const ElasticTensor tensor = elastic_tensor(body.network, state.box.volume(), 1e-10);
        const auto [kn, kt, torsion, bending] = body.network.stiffness.front();
        const double l = 1e-7;
        CHECK(tensor.converged);
        check_cubic(tensor.stiffness, kn / l, 0.0, kt / (2.0 * l));
    }
}

TEST_CASE("face-centred cubic: C11 = sqrt2 (kn + kt)/l, C12 = (kn - kt)/(sqrt2 l), C44 = (kn + kt)/(sqrt2 l)") {
    for (const int cells : {1, 5}) {
        const State state =
            test::make_lattice({.cells = {cells, cells, cells}, .basis = face_centred, .neighbour = std::sqrt(0.5)});
        const BondedBody body = bonded_body(state, {});
        CHECK(body.network.bonds() == 6 * body.network.nodes());
        const ElasticTensor tensor = elastic_tensor(body.network, state.box.volume(), 1e-10);
        const auto [kn, kt, torsion, bending] = body.network.stiffness.front();
        const double l = std::sqrt(0.5) * 1e-7, root = std::sqrt(2.0);
        check_cubic(tensor.stiffness, root * (kn + kt) / l, (kn - kt) / (root * l), (kn + kt) / (root * l));
        check_cubic(tensor.affine, root * (kn + kt) / l, (kn - kt) / (root * l), (kn + kt) / (root * l));
    }
}

TEST_CASE("a disordered cell: symmetric tensor below the affine bound, the same for images of its particles and for any scale") {
    State state = test::make_rough_bar({9, 8, 7});
    const BondedBody body = bonded_body(state, {});
    const ElasticTensor tensor = elastic_tensor(body.network, state.box.volume(), 1e-11);
    CHECK((tensor.stiffness - tensor.stiffness.transpose()).norm() <= 1e-9 * tensor.stiffness.norm());
    CHECK(Eigen::SelfAdjointEigenSolver<Mat6>(tensor.affine - tensor.stiffness).eigenvalues().minCoeff() > 0.0);

    test::scatter_images(state);
    const ElasticTensor moved = elastic_tensor(bonded_body(state, {}).network, state.box.volume(), 1e-11);
    CHECK((moved.stiffness - tensor.stiffness).norm() <= 1e-9 * tensor.stiffness.norm());

    for (const double lambda : {1e-9 / 1e-7, 1.0 / 1e-7}) {
        const State scaled = test::make_rough_bar({9, 8, 7}, 1e-7 * lambda);
        const ElasticTensor other = elastic_tensor(bonded_body(scaled, {}).network, scaled.box.volume(), 1e-11);
        CHECK((other.stiffness - tensor.stiffness).norm() <= 1e-9 * tensor.stiffness.norm());
        CHECK(other.iterations == tensor.iterations);
    }
}

TEST_CASE("an elastic tensor: the same bytes for any number of threads") {
    const State state = test::make_rough_bar({14, 14, 14});
    const BondNetwork network = bonded_body(state, {}).network;
    const int before = threads();
    std::vector<Mat6> tensors;
    for (const int count : {1, 2, 3}) {
        set_threads(count);
        tensors.push_back(elastic_tensor(network, state.box.volume(), 1e-8).stiffness);
    }
    set_threads(before);
    CHECK(tensors[0] == tensors[1]);
    CHECK(tensors[0] == tensors[2]);
}

TEST_CASE("averages of an isotropic tensor are its own constants; of a cubic one, Zener's ratio decides the anisotropy") {
    const double young = 3.0, poisson = 0.2, shear = young / (2.0 * (1.0 + poisson)),
                 lame = 2.0 * shear * poisson / (1.0 - 2.0 * poisson);
    Mat6 stiffness = Mat6::Zero();
    stiffness.topLeftCorner<3, 3>().setConstant(lame);
    stiffness.diagonal().head<3>().array() += 2.0 * shear;
    stiffness.diagonal().tail<3>().setConstant(shear);
    IsotropicAverage average = isotropic_average(stiffness);
    CHECK(average.young_modulus == relative(young, 1e-13));
    CHECK(average.poisson_ratio == relative(poisson, 1e-12));
    CHECK(std::abs(average.anisotropy) < 1e-12);

    const double zener = 1.7;
    stiffness.diagonal().tail<3>() *= zener;
    average = isotropic_average(stiffness);
    CHECK(average.anisotropy == relative(1.2 * std::pow(std::sqrt(zener) - 1.0 / std::sqrt(zener), 2.0), 1e-12));
    CHECK_THROWS_WITH_AS(isotropic_average(Mat6::Zero()), doctest::Contains("not positive definite"), Error);
}
