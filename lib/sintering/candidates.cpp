// candidates.cpp: choice by expected motion, the data of each pair, and the check that none was left out.
#include "sintering/candidates.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>

namespace kiln::sintering {

namespace {

constexpr double least_reach = 0.04;   // of the mean radius, that candidates for touch may be apart
constexpr double guess_margin = 2.0;   // of the closing that is guessed, that makes a candidate
constexpr double harmless_overlap = 0.05;  // of the mean closing of contacts in a step, that a pair left out may reach

}  // namespace

double Candidates::overlap(const Pair& pair) const {
    const auto [first, second] = body_.radii(pair);
    return first + second - body_.vector(pair).norm();
}

double Candidates::end_overlap(const Pair& pair, const Motion& motion) const {
    const auto [first, second] = body_.radii(pair);
    const Vec3 vector = body_.vector(pair);
    const Eigen::Map<const Vec3> a(&motion.displacement[3 * static_cast<std::size_t>(pair.i)]);
    const Eigen::Map<const Vec3> b(&motion.displacement[3 * static_cast<std::size_t>(pair.j)]);
    return first + second - (vector + b - a + motion.strain.cwiseProduct(vector)).norm();
}

PairStep Candidates::pair_step(const Pair& pair, const std::vector<double>& diffusion, double unit) const {
    const auto [first, second] = body_.radii(pair);
    const std::size_t kind = kinetics_.row(body_.particles(), pair);
    PairStep step{};
    step.vector = step.lever = body_.vector(pair);
    step.distance = step.vector.norm();
    step.overlap = first + second - step.distance;
    step.reduced_radius = physics::reduced_radius(first, second);
    if (kinetics_.rigid(kind)) {
        step.limit = std::max(0.0, -step.overlap);
        return step;
    }
    const double most = physics::overlap_of_neck(kinetics_.neck_limit(kind) * std::min(first, second), step.reduced_radius);
    step.limit = std::max(0.0, most - step.overlap);
    step.force = unit * physics::sintering_force(constants_, step.reduced_radius, kinetics_.surface_energy(kind));
    step.cubic = unit * physics::normal_viscosity_factor(constants_, step.reduced_radius) / diffusion[kind];
    step.shear = unit * physics::tangential_viscosity(constants_, 1.0, step.reduced_radius) / diffusion[kind];
    return step;
}

void Candidates::choose(const Motion& guess, const Motion& other, const std::vector<double>& diffusion) {
    // Forces in a unit that makes stiffness a plain number near one, whatever the sizes, times and temperatures.
    const double radius = body_.mean_radius();
    unit_ = *std::max_element(diffusion.begin(), diffusion.end()) /
            (physics::normal_viscosity_factor(constants_, 0.5 * radius) * radius * radius);
    lists_ = body_.lists();
    const double reach = least_reach * radius + 2.0 * radius * guess.strain.cwiseAbs().maxCoeff();
    const auto expected = [&](const Pair& pair) {
        return &guess == &other ? end_overlap(pair, guess) : std::max(end_overlap(pair, guess), end_overlap(pair, other));
    };
    const std::vector<Pair>& list = body_.pairs();
    std::vector<std::uint8_t> kind(list.size());  // 0 out, 1 apart, 2 touching, 3 sticking
#pragma omp parallel for schedule(static)
    for (std::size_t row = 0; row < list.size(); ++row) {
        const Pair& pair = list[row];
        const double start = overlap(pair);
        if (sticks(body_, kinetics_, pair))
            kind[row] = 3;
        else if (start >= 0.0)
            kind[row] = 2;
        else if (start + reach > 0.0 || start + guess_margin * (expected(pair) - start) + reach > 0.0)
            kind[row] = 1;
    }
    for (auto* part : {&pairs_, &chosen_, &left_out_, &touching_, &sticking_}) part->clear();
    for (std::size_t row = 0; row < list.size(); ++row) {
        (kind[row] == 0 ? left_out_ : chosen_).push_back(list[row]);
        if (kind[row] == 0) continue;
        if (kind[row] >= 2) touching_.push_back(list[row]);
        (kind[row] == 3 ? sticking_ : pairs_).push_back(list[row]);
    }
    steps_.resize(pairs_.size());
#pragma omp parallel for schedule(static)
    for (std::size_t row = 0; row < pairs_.size(); ++row) steps_[row] = pair_step(pairs_[row], diffusion, unit_);
}

bool Candidates::complete(const Motion& motion) const {
    const double harmless = harmless_overlap * 2.0 * body_.mean_radius() * motion.strain.cwiseAbs().maxCoeff();
    const auto touching_among = [&](const std::vector<Pair>& pairs) {
        std::size_t count = 0;
#pragma omp parallel for schedule(static) reduction(+ : count)
        for (const Pair& pair : pairs) count += end_overlap(pair, motion) > harmless;
        return count;
    };
    if (lists_ == body_.lists()) return touching_among(left_out_) == 0;
    return touching_among(body_.pairs()) == touching_among(chosen_);  // a new list holds the chosen as well
}

void Candidates::turn_to_nodes(const RigidClusters& clusters) {
    if (sticking_.empty()) return;
    struct Row {
        Pair pair;
        PairStep step;
    };
    std::vector<Row> rows;
    for (std::size_t row = 0; row < pairs_.size(); ++row) {
        bool turned = false;
        const Pair seen = clusters.seen(pairs_[row], turned);
        if (RigidClusters::inert(seen)) continue;
        PairStep step = steps_[row];
        if (turned) step.vector = -step.vector;
        step.lever = pair_vector(body_.box(), clusters.places(), seen);
        rows.push_back({seen, step});
    }
    std::stable_sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) {
        return std::tie(a.pair.i, a.pair.j, a.pair.image) < std::tie(b.pair.i, b.pair.j, b.pair.image);
    });
    pairs_.clear();
    steps_.clear();
    for (const Row& row : rows) {
        pairs_.push_back(row.pair);
        steps_.push_back(row.step);
    }
}

}  // namespace kiln::sintering
