// elastic_tensor.cpp: stresses of a periodic cell under uniform strains, and averages of its tensor.
#include "mechanics/elastic_tensor.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>

#include "core/parallel.h"
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

/// Three at once; what each does is a column.
using Strains = std::array<Mat3, 3>;

using Spring = linalg::Spring<double>;

/// Elongations of a spring where its ends follow the strains, over twice the rotation length.
Mat3 affine_stretch(const Vec3& arm, const Strains& strains) {
    Mat3 stretch;
    for (int k = 0; k < 3; ++k) stretch.col(k) = strains[static_cast<std::size_t>(k)] * arm;
    return stretch;
}

/// Forces on the first node of a spring, N, for relative displacements, m.
Mat3 force_of(const Spring& spring, const Vec3& arm, const Mat3& displacement) {
    return spring.shear * displacement + (spring.axial * arm) * (arm.transpose() * displacement);
}

/// What the springs do to their nodes where all nodes follow the strains and do not turn.
linalg::Batch<3> strain_loads(const linalg::Springs<double>& springs, const Strains& strains, double rotation_length) {
    linalg::Batch<3> load(springs.nodes(), linalg::Values<double, 3>::Zero());
    for_chunks(springs.chunks(), [&](std::size_t chunk) {
        const auto [first, last] = springs.nodes_of(chunk);
        const auto add = [&, first = first, last = last](std::int32_t end, double sign, const Mat3& force, const Mat3& moment) {
            const auto node = static_cast<std::size_t>(end);
            if (node < first || node >= last) return;
            load[node].topRows<3>() += sign * force;
            load[node].bottomRows<3>() += moment;
        };
        springs.for_springs(chunk, [&](const Spring& spring) {
            const Eigen::Map<const Vec3> arm(spring.arm);
            const Mat3 force = force_of(spring, arm, 2.0 * rotation_length * affine_stretch(arm, strains));
            Mat3 moment;
            for (int k = 0; k < 3; ++k) moment.col(k) = arm.cross(force.col(k));
            add(spring.first, 1.0, force, moment);
            add(spring.second, -1.0, force, moment);
        });
    });
    return load;
}

/// Mean stresses, Pa, one column of six Voigt components for each strain: sum of force times bond vector over the volume (Love
/// 1927).
struct Stresses {
    Eigen::Matrix<double, 6, 3> affine = Eigen::Matrix<double, 6, 3>::Zero(), relaxed = affine;

    Stresses& operator+=(const Stresses& other) {
        affine += other.affine;
        relaxed += other.relaxed;
        return *this;
    }
};

void add_products(const Mat3& force, const Vec3& arm, Eigen::Matrix<double, 6, 3>& sum) {
    for (int k = 0; k < 3; ++k) {
        const Mat3 product = force.col(k) * arm.transpose();
        const Mat3 symmetric = product + product.transpose();
        sum.col(k) += (Vec6() << symmetric(0, 0), symmetric(1, 1), symmetric(2, 2), symmetric(1, 2), symmetric(0, 2),
                       symmetric(0, 1)).finished();
    }
}

Stresses stresses(const linalg::Springs<double>& springs, const Strains& strains, const linalg::Batch<3>& motion,
                  double rotation_length, double volume) {
    constexpr std::size_t in_chunk = 1024;
    const std::vector<Spring>& all = springs.springs();
    Stresses sum = sum_chunks((all.size() + in_chunk - 1) / in_chunk, Stresses(), [&](std::size_t chunk) {
        Stresses part;
        for (std::size_t k = chunk * in_chunk; k < std::min(all.size(), (chunk + 1) * in_chunk); ++k) {
            const Spring& spring = all[k];
            const Eigen::Map<const Vec3> arm(spring.arm);
            const linalg::Values<double, 3>& first = motion[static_cast<std::size_t>(spring.first)];
            const linalg::Values<double, 3>& second = motion[static_cast<std::size_t>(spring.second)];
            const Mat3 affine = 2.0 * rotation_length * affine_stretch(arm, strains);
            const Mat3 turning = first.bottomRows<3>() + second.bottomRows<3>();
            Mat3 relaxed = affine + second.topRows<3>() - first.topRows<3>();
            for (int field = 0; field < 3; ++field) relaxed.col(field) += arm.cross(turning.col(field));
            add_products(force_of(spring, arm, affine), arm, part.affine);
            add_products(force_of(spring, arm, relaxed), arm, part.relaxed);
        }
        return part;
    });
    sum.affine *= rotation_length / volume;
    sum.relaxed *= rotation_length / volume;
    return sum;
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

ElasticTensor elastic_tensor(BondNetwork network, double volume, double tolerance, const StopRequest& stop,
                             const LinearSolverMaker& other) {
    ElasticSolver solver(network, Ground::displacement, stop, other);
    const double rotation_length = network.rotation_length;
    network = {};
    ElasticTensor tensor;
    for (const int first : {0, 3}) {
        const Strains strains{unit_strain(first), unit_strain(first + 1), unit_strain(first + 2)};
        const linalg::Batch<3> load = strain_loads(solver.springs(), strains, rotation_length);
        linalg::Batch<3> displacement;
        for (const linalg::SolveReport& report : solver.solve(load, displacement, tolerance)) {
            tensor.iterations += report.iterations;
            tensor.residual = std::max(tensor.residual, report.residual);
            tensor.converged = tensor.converged && report.converged;
        }
        const Stresses stress = stresses(solver.springs(), strains, displacement, rotation_length, volume);
        tensor.affine.middleCols<3>(first) = stress.affine;
        tensor.stiffness.middleCols<3>(first) = stress.relaxed;
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
