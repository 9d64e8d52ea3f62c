// matvec.cpp: memory traffic of an iteration of conjugate gradients on a contact network, beside that of a triad a = b + s c in the
// same run. JSON lines; argument: number of particles along an edge (default 60: 216,000).
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <iostream>
#include <random>

#include "core/parallel.h"
#include "core/spatial_order.h"
#include "io/json.h"
#include "sintering/tangent_solver.h"

namespace {

using namespace kiln;

constexpr int repetitions = 20;
constexpr int inner = 5;

template <typename Work>
double best_seconds(const Work& work) {
    using Clock = std::chrono::steady_clock;
    double best = 1e300;
    for (int repetition = 0; repetition < repetitions; ++repetition) {
        const auto start = Clock::now();
        for (int pass = 0; pass < inner; ++pass) work();
        best = std::min(best, std::chrono::duration<double>(Clock::now() - start).count() / inner);
    }
    return best;
}

void say(const char* part, double bytes, double seconds) {
    std::cout << Json{{"bench", "matvec"}, {"case", part}, {"bytes", bytes}, {"seconds", seconds},
                      {"gigabytes_per_second", 1e-9 * bytes / seconds}, {"threads", threads()}}
                     .dump()
              << std::endl;
}

void triad(std::size_t size) {
    std::vector<double> a(size), b(size, 1.0), c(size, 2.0);
    const auto pass = [&] {
        for_rows(size, [&](std::size_t k) { a[k] = b[k] + 3.0 * c[k]; });
    };
    pass();
    say("triad", 24.0 * static_cast<double>(size), best_seconds(pass));
}

/// A face-centred packing shaken a little, in the order of a space-filling curve: 12 contacts a particle.
std::vector<Vec3> packing(std::size_t edge, Box& box) {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> shake(-0.02, 0.02);
    std::vector<Vec3> position;
    for (std::size_t x = 0; x < edge; ++x)
        for (std::size_t y = 0; y < edge; ++y)
            for (std::size_t z = 0; z < edge; ++z)
                if ((x + y + z) % 2 == 0)
                    position.emplace_back(static_cast<double>(x) + shake(random), static_cast<double>(y) + shake(random),
                                          static_cast<double>(z) + shake(random));
    box.lengths = Vec3::Constant(static_cast<double>(edge));
    std::vector<Vec3> sorted;
    for (const std::int32_t row : spatial_order(box, position, 1.5))
        sorted.push_back(box.wrap(position[static_cast<std::size_t>(row)]));
    return sorted;
}

}  // namespace

int main(int argc, char** argv) {
    const std::size_t edge = argc > 1 ? std::strtoul(argv[1], nullptr, 10) / 2 * 2 : 60;
    Box box;
    const std::vector<Vec3> position = packing(edge, box);
    const std::vector<Pair> pairs = find_pairs(box, position, std::vector<double>(position.size(), 0.76));
    const sintering::ContactNetwork network(box, position, pairs);
    sintering::TangentSolver<float> solver(box, network, pairs);
    std::vector<Vec3> branches;
    for (const Pair& pair : pairs) branches.push_back(pair_vector(box, position, pair));
    for (std::size_t entry = 0; entry < network.pair.size(); ++entry) {
        solver.springs().set_direction(entry, branches[static_cast<std::size_t>(network.pair[entry])].normalized());
        solver.springs().set(entry, 1.0, 0.1);
    }
    solver.factorise(branches);
    sintering::Motion force(position.size()), motion(position.size());
    for (std::size_t k = 0; k < force.displacement.size(); ++k) force.displacement[k] = static_cast<double>(k % 17) - 8.0;
    const auto particles = static_cast<double>(position.size()), entries = static_cast<double>(network.first.size());

    triad(static_cast<std::size_t>(particles) * 32);
    // A contact inside a chunk comes twice with 20 bytes and the index of a particle, another once with two; a particle with the
    // diagonal block and its forces against strains, 32 and 48 bytes, three times with the inverse, 32, and vectors of 16.
    double inside = 0.0;
    for (const auto& chunk : network.chunks()) inside += static_cast<double>(chunk.first_only - chunk.begin);
    constexpr int iterations = 20;
    const double seconds = best_seconds([&] {
        solver.solve(Eigen::Matrix3d::Identity(), force, motion,
                     [](const linalg::CgProgress& progress) { return progress.iterations == iterations; });
    });
    say("iteration", 48.0 * inside + 28.0 * (entries - inside) + 416.0 * particles, seconds / iterations);
}
