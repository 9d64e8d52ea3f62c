// network_test.cpp: bond networks against beam theory and the theorems of linear elasticity; the solver's cost and repeatability.
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <type_traits>

#include "bending/equilibria.h"
#include "core/parallel.h"
#include "mechanics/elastic_solver.h"
#include "tests/physics/assembled.h"
#include "tests/physics/bonded_lattice.h"
#include "tests/physics/relative.h"

using namespace kiln;
using namespace kiln::linalg;
using namespace kiln::mechanics;
using test::relative;

namespace {

/// A force (N) at one node, held in balance by a force and a moment at another one.
Vector balanced_load(const BondNetwork& network, std::size_t node, std::size_t holder, const Vec3& force) {
    Vector load(network.nodes(), Vec6::Zero());
    const Vec3 lever = network.position[node] - network.position[holder];
    load[node].head<3>() += force;
    load[holder].head<3>() -= force;
    load[holder].tail<3>() -= lever.cross(force) / network.rotation_length;
    return load;
}

State rough_bar(std::array<int, 3> cells) {
    State state = test::make_lattice({.cells = cells, .neighbour = 1.25, .periodic = false, .jitter = 0.2, .random_radii = true});
    return state;
}

Vector solved(const BondNetwork& network, const Vector& load, double tolerance = 1e-12) {
    ElasticSolver solver(network, Ground::displacement_and_rotation);
    Vector displacement;
    const linalg::SolveReport report = solver.solve(load, displacement, tolerance);
    CHECK(report.converged);
    return displacement;
}

double stored_energy(const BondNetwork& network, const Vector& displacement) {
    ElasticSolver solver(network, Ground::displacement_and_rotation);
    Vector force;
    solver.forces(displacement, force);
    return dot(displacement, force) / 2.0;
}

/// Sum over the bonds at each node of what they do to it.
Vector nodal_forces(const BondNetwork& network, const std::vector<BondLoad>& loads) {
    Vector forces(network.nodes(), Vec6::Zero());
    for (std::size_t bond = 0; bond < loads.size(); ++bond) {
        const BondLoad& load = loads[bond];
        const Vec3 moment = 0.5 * network.vector[bond].cross(load.force);
        for (const std::size_t end : {0u, 1u}) {
            const double sign = end == 0 ? 1.0 : -1.0;
            Vec6& on_node = forces[static_cast<std::size_t>(network.pair[bond][end])];
            on_node.head<3>() += sign * load.force;
            on_node.tail<3>() += (moment + sign * load.moment) / network.rotation_length;
        }
    }
    return forces;
}

}  // namespace

TEST_CASE("a cantilever of bonds bends by L3/(3 E I)(1 - l2/(4 L2)) + L/(G A), stretches by L/(E A), twists by L/(G J)") {
    constexpr int bonds = 40;
    const State state = test::make_lattice({.cells = {bonds + 1, 1, 1}, .periodic = false});
    const BondNetwork network = bonded_body(state, {physics::BondLaw::centre, physics::BondShear::section}).network;
    const double l = 1e-7, L = bonds * l, r = state.bonds->radius.front(), A = std::numbers::pi * r * r, I = A * r * r / 4.0;
    const double E = *state.materials.front().young_modulus, G = E / (2.0 * (1.0 + *state.materials.front().poisson_ratio));
    const auto tip_against_root = [&](const Vector& u) -> Vec3 {
        const Vec3 turn = u.front().tail<3>() / network.rotation_length;
        return u.back().head<3>() - u.front().head<3>() - turn.cross(Vec3(L, 0.0, 0.0));
    };
    const Vector bent = solved(network, balanced_load(network, bonds, 0, Vec3(0.0, 0.0, 1.0)));
    CHECK(tip_against_root(bent)[2] == relative(L * L * L / (3.0 * E * I) * (1.0 - l * l / (4.0 * L * L)) + L / (G * A), 1e-8));
    const Vector pulled = solved(network, balanced_load(network, bonds, 0, Vec3(1.0, 0.0, 0.0)));
    CHECK(tip_against_root(pulled)[0] == relative(L / (E * A), 1e-8));
    Vector torque(network.nodes(), Vec6::Zero());
    torque.back()[3] = 1.0 / network.rotation_length;
    torque.front()[3] = -1.0 / network.rotation_length;
    const Vector twisted = solved(network, torque);
    CHECK((twisted.back()[3] - twisted.front()[3]) / network.rotation_length == relative(L / (G * 2.0 * I), 1e-8));
}

TEST_CASE("with Timoshenko's beam the cantilever is exact for any number of bonds: L3/(3 E I) + L/(kappa G A)") {
    for (const int bonds : {1, 2, 9}) {
        const State state = test::make_lattice({.cells = {bonds + 1, 1, 1}, .periodic = false});
        const BondNetwork network = bonded_body(state, {physics::BondLaw::centre, physics::BondShear::timoshenko}).network;
        const double L = bonds * 1e-7, r = state.bonds->radius.front(), A = std::numbers::pi * r * r, I = A * r * r / 4.0;
        const double E = *state.materials.front().young_modulus, nu = *state.materials.front().poisson_ratio;
        const double shear = 6.0 * (1.0 + nu) / (7.0 + 6.0 * nu) * E / (2.0 * (1.0 + nu)) * A;
        const Vector u = solved(network, balanced_load(network, network.nodes() - 1, 0, Vec3(0.0, 0.0, 1.0)));
        const Vec3 turn = u.front().tail<3>() / network.rotation_length;
        const double tip = u.back()[2] - u.front()[2] - turn.cross(Vec3(L, 0.0, 0.0))[2];
        CHECK(tip == relative(L * L * L / (3.0 * E * I) + L / shear, 1e-8));
    }
}

TEST_CASE("rigid motions store no energy and load no bond") {
    const BondNetwork network = bonded_body(rough_bar({9, 4, 4}), {}).network;
    const Vec3 turn(0.3, -0.2, 0.5), shift(1e-9, 2e-9, -1e-9);
    Vector motion(network.nodes());
    for (std::size_t i = 0; i < network.nodes(); ++i)
        motion[i] << shift + turn.cross(network.position[i]), turn * network.rotation_length;
    Vector force;
    multiply(Springs<double>(network.nodes(), springs_of(network)), motion, force);
    const double typical = network.stiffness.front().normal * norm(motion);
    CHECK(norm(force) <= 1e-12 * typical);
    for (const BondLoad& load : bond_loads(network, motion)) CHECK(load.force.norm() <= 1e-12 * typical);
}

TEST_CASE("forces of the matrix are those of the bonds") {
    const BondNetwork network = bonded_body(rough_bar({7, 4, 4}), {}).network;
    Vector displacement(network.nodes()), force;
    for (std::size_t i = 0; i < network.nodes(); ++i) {
        for (int k = 0; k < 6; ++k) displacement[i][k] = std::sin(static_cast<double>(7 * i) + 3.0 * k);
    }
    multiply(test::stiffness_matrix(network), displacement, force);
    const Vector from_bonds = nodal_forces(network, bond_loads(network, displacement));
    add(1.0, from_bonds, force);
    CHECK(norm(force) <= 1e-13 * norm(from_bonds));
}

TEST_CASE("reciprocity, linearity, and work equal to the stored energy") {
    const BondNetwork network = bonded_body(rough_bar({24, 6, 6}), {}).network;
    const std::size_t last = network.nodes() - 1;
    const Vector load_a = balanced_load(network, last, 0, Vec3(0.0, 0.0, 1e-6));
    const Vector load_b = balanced_load(network, last / 2, 3, Vec3(1e-6, 2e-6, 0.0));
    const Vector a = solved(network, load_a), b = solved(network, load_b);
    CHECK(dot(load_a, b) == relative(dot(load_b, a), 1e-9));
    Vector both = load_a;
    add(2.0, load_b, both);
    Vector difference = solved(network, both);
    const double size = norm(difference);
    add(-1.0, a, difference);
    add(-2.0, b, difference);
    CHECK(norm(difference) <= 1e-8 * size);
    CHECK(stored_energy(network, a) == relative(dot(load_a, a) / 2.0, 1e-9));
}

TEST_CASE("iterations grow neither with the number of particles nor with slenderness") {
    for (const std::array cells : {std::array{8, 5, 5}, std::array{24, 8, 8}, std::array{48, 12, 12}, std::array{200, 5, 5}}) {
        const BondNetwork network = bonded_body(rough_bar(cells), {}).network;
        ElasticSolver solver(network, Ground::displacement_and_rotation);
        const Vector load = balanced_load(network, network.nodes() - 1, network.nodes() / 2, Vec3(0.0, 0.0, 1e-6));
        Vector displacement;
        const linalg::SolveReport report = solver.solve(load, displacement, 1e-8);
        CHECK(report.iterations <= 40);
        CHECK(report.iterations > 0);
        CHECK(solver.preconditioner().complexity() < 2.0);
    }
}

TEST_CASE("the preconditioner is symmetric and positive, to the rounding of its levels; three fields give what one gives") {
    const BondNetwork network = bonded_body(rough_bar({50, 10, 10}), {}).network;
    const auto check = [&]<typename Real>(Real rounding) {
        Springs<double> springs(network.nodes(), springs_of(network));
        springs.hold(0, Vec6::Constant(network.stiffness.front().normal));
        linalg::NodeGeometry geometry{network.position, Vec3::Zero()};
        for (Vec3& position : geometry.position) position /= network.rotation_length;
        linalg::BasicMultigrid<Real> preconditioner(springs, geometry, 2.0);
        CHECK(preconditioner.levels() >= 3);
        Vector a(network.nodes()), b(network.nodes());
        Batch<3> both(network.nodes(), Values<double, 3>::Zero()), preconditioned(network.nodes());
        for (std::size_t i = 0; i < network.nodes(); ++i) {
            for (int k = 0; k < 6; ++k) {
                a[i][k] = std::sin(static_cast<double>(5 * i) + 2.0 * k);
                b[i][k] = std::cos(static_cast<double>(3 * i) - 1.0 * k);
            }
            both[i].col(0) = a[i];
            both[i].col(2) = b[i];
        }
        const auto apply = [&](const Vector& r) {
            const auto [motion, unit] = preconditioner.template apply<1>(r, PerField<1>(norm(r)));
            Vector z(r.size());
            for (std::size_t i = 0; i < r.size(); ++i) z[i] = unit[0] * values_of(motion[i]);
            return z;
        };
        const Vector pa = apply(a), pb = apply(b);
        CHECK(dot(a, pb) == relative(dot(b, pa), rounding));
        CHECK(dot(a, pa) > 0.0);
        const auto [motion, unit] = preconditioner.template apply<3>(both, norms<3>(both));
        double difference = 0.0, size = 0.0;
        for (std::size_t i = 0; i < network.nodes(); ++i) {
            const Values<double, 3> z = values_of(motion[i]) * unit.matrix().asDiagonal();
            difference += (z.col(0) - pa[i]).squaredNorm() + (z.col(2) - pb[i]).squaredNorm();
            size += pa[i].squaredNorm() + pb[i].squaredNorm();
            CHECK(z.col(1).isZero(0.0));
        }
        CHECK(std::sqrt(difference / size) < rounding);
    };
    check(1e-10);
    check(1e-4f);
}

/// What no other test asks of the solver: loads side by side that end at different iterations, one that is zero, and one whose
/// search starts at its end.
TEST_CASE("three loads at once: each as if it were alone, in its own number of iterations") {
    const BondNetwork network = bonded_body(rough_bar({24, 6, 6}), {}).network;
    ElasticSolver solver(network, Ground::displacement_and_rotation);
    const std::size_t last = network.nodes() - 1;
    std::vector<Vector> loads;
    for (const Vec3& force : {Vec3(0.0, 0.0, 1e-6), Vec3(0.0, 0.0, 0.0), Vec3(1e3, 0.0, 0.0), Vec3(1e-20, 2e-20, 0.0)})
        loads.push_back(balanced_load(network, last, 0, force));
    loads.push_back(balanced_load(network, 1, 0, Vec3(0.0, 1.0, 0.0)));
    loads.push_back(loads.front());
    const Vector known = solved(network, loads[5]);
    std::array<linalg::SolveReport, 6> reports;
    for (const std::size_t first : {0, 3}) {
        Batch<3> load(network.nodes()), x(network.nodes(), Values<double, 3>::Zero());
        for (std::size_t node = 0; node < network.nodes(); ++node) {
            for (std::size_t k = 0; k < 3; ++k) load[node].col(static_cast<Eigen::Index>(k)) = loads[first + k][node];
            if (first == 3) x[node].col(2) = known[node];
        }
        std::ranges::copy(solver.solve(load, x, 1e-10), &reports[first]);
        for (std::size_t k = first; k < first + 3; ++k) {
            CAPTURE(k);
            Vector alone, rest(network.nodes());
            if (k == 5) alone = known;
            const linalg::SolveReport report = solver.solve(loads[k], alone, 1e-10);
            CHECK(reports[k].converged);
            CHECK(reports[k].residual <= 1e-10);
            CHECK(std::abs(reports[k].iterations - report.iterations) <= 1);  // rounding decides the last one
            for (std::size_t node = 0; node < network.nodes(); ++node)
                rest[node] = x[node].col(static_cast<Eigen::Index>(k - first)) - alone[node];
            CHECK(norm(rest) <= 1e-7 * norm(alone));
        }
    }
    CHECK(reports[1].iterations == 0);
    CHECK(reports[5].iterations == 0);
    CHECK(reports[0].iterations != reports[4].iterations);
}

TEST_CASE("bonds of a hundred million times each other's stiffness: the true residual comes down all the same") {
    BondNetwork network = bonded_body(rough_bar({16, 6, 6}), {}).network;
    for (std::size_t bond = 0; bond < network.bonds(); ++bond) {
        const double factor = std::pow(10.0, static_cast<double>(bond * 7919 % 9) - 8.0);
        for (double* stiffness : {&network.stiffness[bond].normal, &network.stiffness[bond].shear, &network.stiffness[bond].bending,
                                  &network.stiffness[bond].torsion})
            *stiffness *= factor;
    }
    const Vector load = balanced_load(network, network.nodes() - 1, 0, Vec3(1e-6, 2e-6, 1e-6));
    const Vector u = solved(network, load, 1e-8);
    Vector held;
    multiply(test::stiffness_matrix(network), u, held);
    add(-1.0, load, held);
    CHECK(norm(held) <= 2e-8 * norm(load));
}

TEST_CASE("the same bytes for any number of threads") {
    const BondNetwork network = bonded_body(rough_bar({40, 8, 8}), {}).network;
    const Vector load = balanced_load(network, network.nodes() - 1, 0, Vec3(1e-6, 0.0, 1e-6));
    const int before = threads();
    set_threads(1);
    const Vector one = solved(network, load, 1e-8);
    for (const int count : {2, 3}) {
        set_threads(count);
        const Vector several = solved(network, load, 1e-8);
        bool same = true;
        for (std::size_t i = 0; i < one.size(); ++i) same = same && one[i] == several[i];
        CHECK(same);
    }
    set_threads(before);
}

TEST_CASE("what refers to parts of itself can be neither copied nor moved") {
    CHECK_FALSE(std::is_copy_constructible_v<ElasticSolver>);
    CHECK_FALSE(std::is_move_constructible_v<ElasticSolver>);
    CHECK_FALSE(std::is_copy_constructible_v<linalg::Multigrid>);
    CHECK_FALSE(std::is_move_constructible_v<linalg::Multigrid>);
    CHECK_FALSE(std::is_copy_constructible_v<bending::Equilibria>);
    CHECK_FALSE(std::is_move_constructible_v<bending::Equilibria>);
}

TEST_CASE("fragments, particles without a bond, bonds too thin to carry") {
    State state = test::make_lattice({.cells = {20, 3, 3}, .periodic = false});
    // A second, smaller body: the slices from 15 on; slice 14 loses all its bonds but one, a thread.
    const auto slice = [&](std::int32_t particle) { return static_cast<int>(particle / 9); };
    std::vector<std::int32_t> kept;
    for (std::size_t bond = 0; bond < state.bonds->size(); ++bond) {
        const auto [i, j] = state.bonds->pair[bond];
        const bool thread = i == 13 * 9 + 4 && j == 14 * 9 + 4;
        if (thread) state.bonds->radius[bond] = 1e-5 * state.particles.radius.front();
        if (thread || (slice(i) != 14 && slice(j) != 14)) kept.push_back(static_cast<std::int32_t>(bond));
    }
    state.bonds = take_rows(*state.bonds, kept);
    const BondedBody body = bonded_body(state, {});
    CHECK(body.particle.size() == 14 * 9);
    CHECK(body.fragments == 1);
    CHECK(body.fragment_particles == 5 * 9);
    CHECK(body.rattlers == 9);
    CHECK(body.negligible_bonds == 1);
}

TEST_CASE("a particle on one thin bond, bonds without length: solved, and the thin bond carries what hangs on it") {
    State state = rough_bar({20, 5, 5});
    for (double& length : state.bonds->length) length = 0.0;
    Particles& particles = state.particles;
    const auto end = static_cast<std::int32_t>(particles.size());
    particles.id.push_back(end);
    particles.position.push_back(particles.position.back() + Vec3(1e-7, 0.0, 0.0));
    particles.radius.push_back(particles.radius.back());
    particles.material.push_back(0);
    state.bonds->pair.push_back({end - 1, end});
    state.bonds->image.push_back({0, 0, 0});
    state.bonds->radius.push_back(0.005 * particles.radius.back());
    state.bonds->length.push_back(1e-8);
    state.bonds->volume.push_back(0.0);
    const BondedBody body = bonded_body(state, {});
    const BondNetwork& network = body.network;
    std::size_t hanging = 0;
    while (body.particle[hanging] != end) ++hanging;
    const double force = 1e-12;
    const Vector u = solved(network, balanced_load(network, hanging, 0, Vec3(force, 0.0, 0.0)), 1e-8);
    CHECK(bond_loads(network, u).back().tension == relative(force, 1e-6));
}

TEST_CASE("what cannot be solved is refused by name") {
    State state = test::make_lattice({.cells = {3, 1, 1}, .periodic = false});
    State without = state;
    without.bonds.reset();
    CHECK_THROWS_WITH_AS(bonded_body(without, {}), "the state has no bonds; run bondify first", Error);
    State soft = state;
    soft.materials.front().young_modulus.reset();
    CHECK_THROWS_WITH_AS(bonded_body(soft, {}), "material 'alumina' has no young_modulus", Error);
    State together = state;
    together.particles.position[1] = together.particles.position[0];
    CHECK_THROWS_WITH_AS(bonded_body(together, {}), doctest::Contains("the centres of particles 0 and 1 coincide"), Error);
    for (double& radius : state.bonds->radius) radius = 0.0;
    CHECK_THROWS_WITH_AS(bonded_body(state, {}), doctest::Contains("no bond of the state is thick enough"), Error);
}
