// mechanics.cpp: the elastic solver against the number of particles, the slenderness of the bar and the tolerance asked for.
// Bars are disordered lattices with bonds from thin to thick. `mechanics N...` measures bars of other sizes, as memory allows.
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>

#include "core/neighbours.h"
#include "io/json.h"
#include "mechanics/elastic_solver.h"
#include "physics/materials.h"

namespace {

using namespace kiln;
using namespace kiln::linalg;
using namespace kiln::mechanics;

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Peak memory of the process so far, GB.
double peak_memory() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) * 1024e-9;
}

/// Alumina spheres on a simple cubic lattice without order: positions and bond radii at random, neighbours up to 1.25 edges.
State disordered_bar(int along, int across) {
    constexpr double edge = 1e-7, neighbour = 1.25, jitter = 0.2;  // m; in edges
    State state;
    state.materials.push_back(physics::builtin_material("alumina"));
    state.box.periodic.fill(false);
    state.box.lengths = edge * Vec3(along, across, across);
    std::mt19937 random(7);
    const auto uniform = [&](double low, double high) { return low + (high - low) * static_cast<double>(random()) / 4294967296.0; };
    for (int site = 0; site < along * across * across; ++site) {
        const Vec3 cell(site / (across * across), site / across % across, site % across);
        Vec3 position = edge * (cell + Vec3::Constant(0.5));
        for (double& coordinate : position) coordinate += edge * uniform(-jitter, jitter);
        state.particles.position.push_back(position);
        state.particles.id.push_back(site);
    }
    const std::size_t count = state.particles.position.size();
    const double radius = 0.45 * neighbour * edge;
    state.particles.radius.assign(count, radius);
    state.particles.material.assign(count, 0);
    Bonds bonds;
    const std::vector<double> reach(count, 0.505 * neighbour * edge);
    for (const Pair& pair : find_pairs(state.box, state.particles.position, reach)) {
        const double distance = pair_vector(state.box, state.particles.position, pair).norm();
        const double bond_radius = radius * uniform(0.1, 0.98);
        bonds.pair.push_back({pair.i, pair.j});
        bonds.image.push_back(pair.image);
        bonds.radius.push_back(bond_radius);
        bonds.length.push_back(std::max(0.0, distance - 2.0 * std::sqrt(radius * radius - bond_radius * bond_radius)));
        bonds.volume.push_back(0.0);
    }
    state.bonds = std::move(bonds);
    return state;
}

/// A bar `slenderness` times as long as it is high and wide, of about as many particles.
BondNetwork bar(double particles, double slenderness) {
    const int across = std::max(2, static_cast<int>(std::lround(std::cbrt(particles / slenderness))));
    const int along = static_cast<int>(std::lround(particles / (across * across)));
    return bonded_body(disordered_bar(along, across), {}).network;
}

/// Three-point bending by point forces, N, without contacts.
Vector bending_load(const BondNetwork& network) {
    Vector load(network.nodes(), Vec6::Zero());
    const std::size_t middle = network.nodes() / 2, first = 0, last = network.nodes() - 1;
    const Vec3 a = network.position[first], b = network.position[last], c = network.position[middle];
    const double share = (c[0] - a[0]) / (b[0] - a[0]);
    load[middle][2] -= 1.0;
    load[first][2] += 1.0 - share;
    load[last][2] += share;
    // Moments about x that the forces' places across the bar leave.
    const double rest = (1.0 - share) * a[1] + share * b[1] - c[1];
    load[middle][3] -= rest / network.rotation_length;
    return load;
}

void size_and_shape(const char* what, double particles, double slenderness) {
    const BondNetwork network = bar(particles, slenderness);
    const Vector load = bending_load(network);
    const Clock::time_point start = Clock::now();
    ElasticSolver solver(network, Ground::displacement_and_rotation);
    const double setup = seconds_since(start);
    Vector displacement;
    const Clock::time_point begin = Clock::now();
    const linalg::SolveReport report = solver.solve(load, displacement, 1e-8);
    const Json line{{"bench", "mechanics"}, {"case", what}, {"particles", network.nodes()}, {"bonds", network.bonds()},
                    {"slenderness", slenderness}, {"iterations", report.iterations}, {"residual", report.residual},
                    {"setup_seconds", setup}, {"solve_seconds", seconds_since(begin)},
                    {"complexity", solver.preconditioner().complexity()}, {"peak_gigabytes", peak_memory()}};
    std::puts(line.dump().c_str());
    std::fflush(stdout);
}

/// Error of the stored energy, and so of the stiffness, against the time it took.
void tolerances() {
    const BondNetwork network = bar(10240, 8);
    const Vector load = bending_load(network);
    ElasticSolver solver(network, Ground::displacement_and_rotation);
    Vector exact;
    solver.solve(load, exact, 1e-13);
    const double energy = dot(load, exact);
    for (const double tolerance : {1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-10}) {
        Vector displacement;
        const Clock::time_point begin = Clock::now();
        const linalg::SolveReport report = solver.solve(load, displacement, tolerance);
        const double seconds = seconds_since(begin);
        Vector difference = exact;
        add(-1.0, displacement, difference);
        const Json line{{"bench", "mechanics"}, {"case", "tolerance"}, {"tolerance", tolerance}, {"iterations", report.iterations},
                        {"solve_seconds", seconds}, {"stiffness_error", std::abs(dot(load, displacement) / energy - 1.0)},
                        {"displacement_error", norm(difference) / norm(exact)}};
        std::puts(line.dump().c_str());
    }
}

}  // namespace

int main(int argc, char** argv) {
    if (argc > 1) {
        for (int k = 1; k < argc; ++k) size_and_shape("size", std::atof(argv[k]), 8.0);
        return 0;
    }
    for (const double particles : {1e3, 3e3, 10240.0, 3e4, 1e5}) size_and_shape("size", particles, 8.0);
    for (const double slenderness : {3.0, 5.0, 10.0, 20.0, 40.0}) size_and_shape("slenderness", 10240.0, slenderness);
    tolerances();
}
