// sintering_contrast_test.cpp: slow contacts beside fast ones: solves beside dense ones, and runs beside the rigid limit.
#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <random>

#include "physics/sinter_contact.h"
#include "sintering/sinter_step.h"
#include "sintering/viscosity.h"
#include "tests/physics/sintering_cases.h"

using namespace kiln;
using namespace kiln::sintering;
using namespace sintering_cases;

namespace {

/// A packing of one particle in seven of a second material whose diffusion parameter is given, m5/(N s).
State mixed_packing(std::int64_t count, double delta) {
    State state = random_packing(count, 0.5, 1.0, 1);  // no branch of this packing hangs on a single slow contact
    state.materials.push_back(state.materials[0]);
    state.materials[1].name = "second";
    state.materials[1].diffusion_parameter = delta;
    for (std::size_t row = 0; row < state.particles.size(); row += 7) state.particles.material[row] = 1;
    return state;
}

SinteringSettings default_settings() {
    SinteringSettings wanted;
    wanted.schedule = physics::Schedule::hold(temperature);
    return wanted;
}

/// A step's convex function with dense algebra: the freedoms are all displacements, then the strains.
class DenseStep {
   public:
    DenseStep(std::size_t particles, std::span<const Pair> pairs, std::span<const PairStep> step)
        : freedoms_(static_cast<Eigen::Index>(3 * particles + 3)), pairs_(pairs), step_(step) {}

    /// Gradient and Hessian at x, with the geometry of the start.
    void evaluate(const Eigen::VectorXd& x, Eigen::VectorXd& gradient, Eigen::MatrixXd& hessian) const {
        gradient = Eigen::VectorXd::Zero(freedoms_);
        hessian = Eigen::MatrixXd::Zero(freedoms_, freedoms_);
        for (std::size_t row = 0; row < step_.size(); ++row) {
            const PairStep& pair = step_[row];
            Eigen::MatrixXd motion = Eigen::MatrixXd::Zero(3, freedoms_);  // relative motion of the pair for each freedom
            motion.block<3, 3>(0, 3 * pairs_[row].j) += Eigen::Matrix3d::Identity();
            motion.block<3, 3>(0, 3 * pairs_[row].i) -= Eigen::Matrix3d::Identity();
            motion.rightCols<3>() = pair.branch.asDiagonal();
            const Vec3 n = pair.vector / pair.distance, du = motion * x;
            const double w = -n.dot(du), start = pair.overlap, reached = std::max(0.0, start + w);
            const double alone = std::cbrt(start * start * start + 3.0 * pair.force / pair.cubic),
                         shear = pair.shear * 0.5 * (start + alone);
            const double approach = reached > 0.0 ? w : -start;
            const double resistance = pair.cubic * (start * start + start * reached + reached * reached) / 3.0 * approach;
            const Vec3 force = (pair.force - resistance) * n + shear * (du - n.dot(du) * n);
            const Eigen::Matrix3d stiffness =
                pair.cubic * reached * reached * n * n.transpose() + shear * (Eigen::Matrix3d::Identity() - n * n.transpose());
            gradient += motion.transpose() * force;
            hessian += motion.transpose() * stiffness * motion;
        }
    }

    /// The minimum, by Newton from rest with halved steps where the gradient would grow; translations are held.
    Eigen::VectorXd minimum() const {
        Eigen::VectorXd x = Eigen::VectorXd::Zero(freedoms_), gradient, next_gradient;
        Eigen::MatrixXd hessian, next_hessian;
        evaluate(x, gradient, hessian);
        for (int iteration = 0; iteration < 200; ++iteration) {
            Eigen::MatrixXd held = hessian;
            for (Eigen::Index a = 0; a < freedoms_ - 3; ++a)
                for (Eigen::Index b = a % 3; b < freedoms_ - 3; b += 3) held(a, b) += 1.0 / static_cast<double>(freedoms_);
            const Eigen::VectorXd direction = -held.ldlt().solve(gradient);
            double length = 1.0;
            for (; length > 1e-6; length *= 0.5) {
                evaluate(x + length * direction, next_gradient, next_hessian);
                if (next_gradient.dot(direction) <= 0.1 * std::abs(gradient.dot(direction))) break;
            }
            x += length * direction;
            evaluate(x, gradient, hessian);
            if (std::sqrt(direction.dot(hessian * direction)) < 1e-12 * std::sqrt(x.dot(hessian * x))) break;
        }
        return x;
    }

    /// Energy norm of x - y over that of y, in the metric at y.
    double distance(const Eigen::VectorXd& x, const Eigen::VectorXd& y) const {
        Eigen::VectorXd gradient;
        Eigen::MatrixXd hessian;
        evaluate(y, gradient, hessian);
        return std::sqrt((x - y).dot(hessian * (x - y)) / y.dot(hessian * y));
    }

   private:
    Eigen::Index freedoms_;
    std::span<const Pair> pairs_;
    std::span<const PairStep> step_;
};

/// Pairs of a packing whose overlaps are h0, one in seven particles `slowness` times slower; lengths in radii, stiffness near one.
struct StepCase {
    State state = random_packing(60, 0.55, 1.0 / 50e-9);
    std::vector<Pair> pairs = find_pairs(state.box, state.particles.position, std::vector<double>(60, 1.01));
    std::vector<PairStep> step;

    explicit StepCase(double slowness) {
        for (const Pair& pair : pairs) {
            PairStep one{};
            one.vector = one.branch = pair_vector(state.box, state.particles.position, pair);
            one.distance = one.vector.norm();
            one.overlap = std::max(0.01, 2.0 - one.distance);
            one.reduced_radius = 0.5;
            one.slowness = pair.i % 7 == 0 || pair.j % 7 == 0 ? slowness : 1.0;
            one.force = 1e-5;
            one.cubic = one.slowness;
            one.shear = 0.02 * one.slowness;
            one.limit = endless;
            step.push_back(one);
        }
    }
};

}  // namespace

TEST_CASE("one step beside a dense solve: contrasts from 1 to 1e12 within 1e-3 in the energy norm") {
    for (const double slowness : {1.0, 1e3, 1e6, 1e9, 1e12}) {
        const StepCase one(slowness);
        StepSettings settings;
        settings.first_tolerance = 3e-4;
        SinterStep step(one.state.box, one.state.particles.position, one.pairs, one.step, settings);
        Motion motion(60);
        const StepReport report = step.first_order(motion);
        CHECK(report.converged);
        CHECK(report.imbalance < 1e-2);
        const DenseStep dense(60, one.pairs, one.step);
        const Eigen::VectorXd exact = dense.minimum();
        Eigen::VectorXd found(183);
        found.head(180) = Eigen::Map<const Eigen::VectorXd>(motion.displacement.data(), 180);
        found.tail(3) = motion.strain;
        INFO("contrast " << slowness);
        CHECK(dense.distance(found, exact) < 1e-3);
        CHECK(report.conjugate_gradients < 2000);
    }
}

TEST_CASE("slow particles: the density of a run beside that of the rigid limit, and viscosities symmetric and positive") {
    const auto density = [](double delta) {
        State state = sintered(mixed_packing(300, delta), 20.0, default_settings());
        const ViscousResponse response = viscous_response(state, {}, temperature);
        CHECK(response.converged);
        if (response.flows()) {
            CHECK((response.viscosity - response.viscosity.transpose()).norm() < 1e-12 * response.viscosity.norm());
            const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> modes(response.viscosity);
            CHECK(modes.eigenvalues()[0] > 0.0);
            CHECK(response.shear_viscosity() > 0.0);
        }
        return relative_density(state);
    };
    const double rigid = density(0.0);
    CHECK(rigid > 0.501);
    for (const double delta : {1e-40, 1e-41, 1e-42, 1e-80}) CHECK(deviation(density(delta), rigid) < 1e-3);
    CHECK(density(1e-36) > 1.01 * rigid);  // a hundred times slower is not rigid
}

TEST_CASE("ordinary contacts of a chain with slow ones close by the pair law, whatever the contrast") {
    const double time = 10.0, radius = 50e-9;
    for (const double delta : {0.0, 1e-80, 1e-44, 1e-40}) {
        State chain = state_of({}, {}, Vec3::Constant(2e-6), false);
        for (int row = 0; row < 4; ++row) {
            chain.particles.position.emplace_back(2e-7 + row * (2.0 * radius - 1e-9), 1e-6, 1e-6);
            chain.particles.radius.push_back(radius);
            chain.particles.material.push_back(row < 2 ? 0 : 1);
            chain.particles.id.push_back(row + 1);
        }
        chain.materials.push_back(chain.materials[0]);
        chain.materials[1].name = "slow";
        chain.materials[1].diffusion_parameter = delta;
        const State end = sintered(chain, time);
        CHECK(deviation(2.0 * radius - distance(end, 0, 1), pair_law(1e-9, 0.5 * radius, time)) < 1e-6);
        CHECK(distance(end, 2, 3) <= distance(chain, 2, 3) * (1.0 + 1e-15));
        CHECK(distance(chain, 2, 3) - distance(end, 2, 3) < 1e-4 * (distance(chain, 0, 1) - distance(end, 0, 1)));
    }
}

TEST_CASE("the sintering stress does not depend on the temperature at which it is asked for, and viscosity goes with Delta") {
    const State state = sintered(random_packing(100, 0.5, 1.0), 30.0, default_settings());
    const auto delta = [](double kelvin) { return physics::diffusion_parameter_of(physics::builtin_material("alumina"), kelvin); };
    const ViscousResponse hot = viscous_response(state, {}, temperature);
    for (const double kelvin : {298.15, 1073.15}) {
        const ViscousResponse cold = viscous_response(state, {}, kelvin);
        CHECK(cold.converged);
        CHECK(deviation(cold.mean_sintering_stress(), hot.mean_sintering_stress()) < 1e-9);
        CHECK(deviation(cold.bulk_viscosity() * delta(kelvin), hot.bulk_viscosity() * delta(temperature)) < 1e-9);
    }
}
