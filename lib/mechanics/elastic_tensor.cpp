// elastic_tensor.cpp: stresses of a periodic cell under uniform strains, and averages of its tensor.
#include "mechanics/elastic_tensor.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "mechanics/elastic_solver.h"

namespace kiln::mechanics {

namespace {

using Mat3 = Eigen::Matrix3d;

Mat3 unit_strain(int component) {
    constexpr int rows[] = {0, 1, 2, 1, 0, 0}, columns[] = {0, 1, 2, 2, 2, 1};
    Mat3 strain = Mat3::Zero();
    strain(rows[component], columns[component]) += 0.5;
    strain(columns[component], rows[component]) += 0.5;
    return strain;
}

/// Mean stress, Pa, as six Voigt components: sum of force times bond vector over the volume (Love 1927).
Vec6 mean_stress(const BondNetwork& network, const std::vector<BondLoad>& loads, double volume) {
    Mat3 sum = Mat3::Zero();
    for (std::size_t bond = 0; bond < loads.size(); ++bond) sum += loads[bond].force * network.vector[bond].transpose();
    const Mat3 stress = (sum + sum.transpose()) / (2.0 * volume);
    Vec6 voigt;
    voigt << stress(0, 0), stress(1, 1), stress(2, 2), stress(1, 2), stress(0, 2), stress(0, 1);
    return voigt;
}

struct Moduli {
    double bulk, shear;
};

Moduli voigt_moduli(const Mat6& c) {
    const double direct = c(0, 0) + c(1, 1) + c(2, 2), cross = c(0, 1) + c(0, 2) + c(1, 2), shear = c(3, 3) + c(4, 4) + c(5, 5);
    return {(direct + 2.0 * cross) / 9.0, (direct - cross + 3.0 * shear) / 15.0};
}

Moduli reuss_moduli(const Mat6& s) {
    const double direct = s(0, 0) + s(1, 1) + s(2, 2), cross = s(0, 1) + s(0, 2) + s(1, 2), shear = s(3, 3) + s(4, 4) + s(5, 5);
    return {1.0 / (direct + 2.0 * cross), 15.0 / (4.0 * (direct - cross) + 3.0 * shear)};
}

/// The inverse of the stiffness, and the stiffness made symmetric.
struct Compliance {
    Mat6 stiffness, compliance;
};

Compliance compliance_of(const Mat6& stiffness) {
    const Mat6 symmetric = (stiffness + stiffness.transpose()) / 2.0;
    const Eigen::LLT<Mat6> factor(symmetric);
    if (factor.info() != Eigen::Success)
        throw Error("the elastic tensor is not positive definite: some strain meets no resistance");
    return {symmetric, factor.solve(Mat6::Identity())};
}

}  // namespace

ElasticTensor elastic_tensor(const BondNetwork& network, double volume, double tolerance, const StopRequest& stop,
                             const LinearSolverMaker& other) {
    ElasticSolver solver(network, Ground::displacement, stop, other);
    ElasticTensor tensor;
    Vector field(network.nodes(), Vec6::Zero());
    linalg::Batch<6> load(network.nodes()), displacement;
    for (int component = 0; component < 6; ++component) {
        const std::vector<BondLoad> affine = bond_loads(network, field, unit_strain(component));
        tensor.affine.col(component) = mean_stress(network, affine, volume);
        const Vector forces = nodal_forces(network, affine);
        for (std::size_t node = 0; node < forces.size(); ++node) load[node].col(component) = forces[node];
    }
    for (const linalg::SolveReport& report : solver.solve(load, displacement, tolerance)) {
        tensor.iterations += report.iterations;
        tensor.residual = std::max(tensor.residual, report.residual);
        tensor.converged = tensor.converged && report.converged;
    }
    for (int component = 0; component < 6; ++component) {
        for (std::size_t node = 0; node < field.size(); ++node) field[node] = displacement[node].col(component);
        tensor.stiffness.col(component) = mean_stress(network, bond_loads(network, field, unit_strain(component)), volume);
    }
    return tensor;
}

IsotropicAverage isotropic_average(const Mat6& stiffness) {
    const auto [symmetric, compliance] = compliance_of(stiffness);
    const auto [bulk, shear] = voigt_moduli(symmetric);
    const auto [reuss_bulk, reuss_shear] = reuss_moduli(compliance);
    const double young = 9.0 * bulk * shear / (3.0 * bulk + shear);
    return {young, shear, bulk, young / (2.0 * shear) - 1.0, 5.0 * shear / reuss_shear + bulk / reuss_bulk - 6.0};
}

Mat6 with_poisson_ratio(const Mat6& stiffness, double poisson_ratio) {
    if (!(poisson_ratio > -1.0 && poisson_ratio < 0.5))
        throw Error("a Poisson's ratio of " + std::to_string(poisson_ratio) + " is not between -1 and 0.5");
    const IsotropicAverage average = isotropic_average(stiffness);
    const double bulk = average.young_modulus / (3.0 * (1.0 - 2.0 * poisson_ratio));
    const double shear = average.young_modulus / (2.0 * (1.0 + poisson_ratio));
    Mat6 dilation = Mat6::Zero();
    dilation.topLeftCorner<3, 3>().setOnes();
    return (stiffness - average.bulk_modulus * dilation) * (shear / average.shear_modulus) + bulk * dilation;
}

Vec3 axial_moduli(const Mat6& stiffness) { return compliance_of(stiffness).compliance.diagonal().head<3>().cwiseInverse(); }

}  // namespace kiln::mechanics
