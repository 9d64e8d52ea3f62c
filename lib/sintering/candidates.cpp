// candidates.cpp: choice by expected motion, the data of each pair, and the check that none was left out.
#include "sintering/candidates.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

#include "core/parallel.h"
#include "physics/coarsening.h"

namespace kiln::sintering {

namespace {

constexpr double limit_stiffness = 100.0;  // of the spring at a limit, over the stiffness of the contact there: it
                                           // yields by a part in a hundred of what the contact would do without
constexpr std::size_t max_pieces = 32;     // of the list of pairs, that threads go through
constexpr double harmless_overlap = 0.05;  // of the mean approach of contacts in a step, that a pair left out may reach

/// Bounds of how much pairs close under a motion, without looking at where their particles are.
class ApproachBound {
   public:
    ApproachBound(const Motion& motion, double max_radius)
        : travel_(motion.displacement.size() / 3), strain_(motion.strain.cwiseAbs().maxCoeff()), touching_(4.0 * max_radius) {
        for_rows(travel_.size(),
                 [&](std::size_t row) { travel_[row] = Eigen::Map<const Vec3>(&motion.displacement[3 * row]).norm(); });
    }

    /// overlap: that of the pair before the motion, m, negative for a gap.
    double operator()(const Pair& pair, double overlap) const {
        return rounding * (travel_[static_cast<std::size_t>(pair.i)] + travel_[static_cast<std::size_t>(pair.j)] +
                           strain_ * (touching_ - overlap));
    }

   private:
    static constexpr double rounding = 1.0 + 1e-9;
    std::vector<double> travel_;  // of each particle, m
    double strain_, touching_;  // touching_: distance of centres without overlap that no pair exceeds, m, whatever its neck adds
};

}  // namespace

double Candidates::max_neck(std::size_t kind, double first, double second) const {
    const auto [small, large] = std::minmax(first, second);
    return coarsens_ ? physics::equilibrium_neck(small, large, kinetics_.neck_limit(kind)) : kinetics_.neck_limit(kind) * small;
}

double Candidates::end_overlap(const Pair& pair, const Motion& motion) const {
    const auto [first, second] = body_.radii(pair);
    const Vec3 vector = body_.vector(pair);
    const Eigen::Map<const Vec3> a(&motion.displacement[3 * static_cast<std::size_t>(pair.i)]);
    const Eigen::Map<const Vec3> b(&motion.displacement[3 * static_cast<std::size_t>(pair.j)]);
    return first + second - (vector + b - a + motion.strain.cwiseProduct(vector)).norm() + body_.offset(pair);
}

PairStep Candidates::pair_step(const Pair& pair, const std::vector<double>& diffusion, double unit) const {
    const auto [first, second] = body_.radii(pair);
    const std::size_t kind = kinetics_.row(body_.particles(), pair);
    PairStep step{};
    step.vector = step.branch = body_.vector(pair);
    step.distance = step.vector.norm();
    step.overlap = contact_overlap(first, second, step.distance - body_.offset(pair));
    step.reduced_radius = physics::reduced_radius(first, second);
    if (kinetics_.rigid(kind)) {
        step.limit = std::max(0.0, -step.overlap);
        return step;
    }
    const double most = physics::overlap_of_neck(max_neck(kind, first, second), step.reduced_radius);
    step.limit = std::max(0.0, most - step.overlap);
    // Of grains that differ a lot, the stiffness of a contact may be hundreds of times that of most: its limit has its own spring.
    if (std::isfinite(most))
        step.spring = limit_stiffness * unit * physics::normal_viscosity_factor(constants_, step.reduced_radius) /
                      diffusion[kind] * physics::viscosity_shape(std::max(most, step.overlap));
    step.slowness = *std::ranges::max_element(diffusion) / diffusion[kind];
    step.force = unit * physics::sintering_force(constants_, step.reduced_radius, kinetics_.surface_energy(kind));
    step.cubic = unit * physics::normal_viscosity_factor(constants_, step.reduced_radius) / diffusion[kind];
    step.shear = unit * physics::tangential_viscosity(constants_, 1.0, step.reduced_radius) / diffusion[kind];
    return step;
}

double Candidates::max_isolated_approach(const std::vector<double>& diffusion) const {
    double most = 0.0;
    for (const Pair& pair : body_.pairs()) {
        const double start = body_.overlap(pair);
        const std::size_t kind = kinetics_.row(body_.particles(), pair);
        if (start < 0.0 || kinetics_.rigid(kind)) continue;
        const PairStep step = pair_step(pair, diffusion, 1.0);
        // The viscosity only grows: the approach is at most that at the first viscosity, and that from no overlap at all.
        const double integral = step.force / step.cubic, from_nothing = physics::overlap_of_integral(0.0, integral);
        most = std::max(most, start > 0.0 ? std::min(integral / physics::viscosity_shape(start), from_nothing) : from_nothing);
    }
    return most / body_.mean_radius();
}

void Candidates::choose(const Motion& guess, const Motion& other, const std::vector<double>& diffusion, bool keep) {
    // Forces in a unit that makes stiffness a plain number near one, whatever the sizes, times and temperatures.
    const double radius = body_.mean_radius();
    unit_ = *std::max_element(diffusion.begin(), diffusion.end()) /
            (physics::normal_viscosity_factor(constants_, 0.5 * radius) * radius * radius);
    lists_ = body_.lists();
    const double reach = body_.candidate_reach(guess);
    const auto expected = [&](const Pair& pair) {
        return &guess == &other ? end_overlap(pair, guess) : std::max(end_overlap(pair, guess), end_overlap(pair, other));
    };
    const ApproachBound bound(guess, body_.max_radius());
    const ApproachBound other_bound = &guess == &other ? bound : ApproachBound(other, body_.max_radius());
    const auto may_close = [&](const Pair& pair, double start) {
        return candidate_motion * std::max(bound(pair, start), other_bound(pair, start));
    };
    const std::vector<Pair>& list = body_.pairs();
    const std::vector<Pair> before = keep ? std::move(chosen_) : std::vector<Pair>{};
    std::vector<std::uint8_t> kind(list.size());  // 0 out, 1 apart, 2 touching, 3 sticking
    std::vector<double> overlap(list.size());
    for_rows(list.size(), [&](std::size_t row) {
        const Pair& pair = list[row];
        const double start = overlap[row] = body_.overlap(pair);
        if (sticks(body_, kinetics_, pair))
            kind[row] = 3;
        else if (start >= 0.0)
            kind[row] = 2;
        else if (keep && std::binary_search(before.begin(), before.end(), pair))
            kind[row] = 1;
        else if (start + reach > 0.0)
            kind[row] = 1;
        else if (start + may_close(pair, start) + reach > 0.0 &&
                 start + candidate_motion * (expected(pair) - start) + reach > 0.0)
            kind[row] = 1;
    });
    const std::size_t pieces = list.size() < worth_threads ? 1 : max_pieces;
    const auto begin_of = [&](std::size_t piece) { return list.size() * piece / pieces; };
    /// Sets `values` to value(row) of the pairs of those kinds, in their order.
    const auto collect = [&](auto& values, const auto& is_of, const auto& value) {
        std::vector<std::size_t> place(pieces + 1, 0);
        for_chunks(pieces, [&](std::size_t piece) {
            place[piece + 1] = static_cast<std::size_t>(
                std::count_if(kind.begin() + static_cast<std::ptrdiff_t>(begin_of(piece)),
                              kind.begin() + static_cast<std::ptrdiff_t>(begin_of(piece + 1)), is_of));
        });
        std::partial_sum(place.begin(), place.end(), place.begin());
        values.resize(place.back());
        for_chunks(pieces, [&](std::size_t piece) {
            std::size_t at = place[piece];
            for (std::size_t row = begin_of(piece); row < begin_of(piece + 1); ++row)
                if (is_of(kind[row])) values[at++] = value(row);
        });
    };
    const auto pair_of = [&](std::size_t row) { return list[row]; };
    const auto left_out = [](std::uint8_t of) { return of == 0; };
    collect(pairs_, [](std::uint8_t of) { return of == 1 || of == 2; }, pair_of);
    collect(chosen_, [](std::uint8_t of) { return of != 0; }, pair_of);
    collect(touching_, [](std::uint8_t of) { return of >= 2; }, pair_of);
    collect(sticking_, [](std::uint8_t of) { return of == 3; }, pair_of);
    collect(left_out_, left_out, pair_of);
    collect(left_out_overlap_, left_out, [&](std::size_t row) { return overlap[row]; });
    steps_.resize(pairs_.size());
    for_rows(pairs_.size(), [&](std::size_t row) { steps_[row] = pair_step(pairs_[row], diffusion, unit_); });
}

bool Candidates::complete(const Motion& motion) const {
    const double harmless = harmless_overlap * 2.0 * body_.mean_radius() * motion.strain.cwiseAbs().maxCoeff();
    const auto touching_among = [&](const std::vector<Pair>& pairs) {
        return join_rows(pairs.size(), std::size_t{0}, [&](std::size_t row) {
            return static_cast<std::size_t>(end_overlap(pairs[row], motion) > harmless);
        }, std::plus());
    };
    if (lists_ == body_.lists()) {
        const ApproachBound bound(motion, body_.max_radius());
        return join_rows(left_out_.size(), std::size_t{0}, [&](std::size_t row) {
            const Pair& pair = left_out_[row];
            const double start = left_out_overlap_[row];
            return static_cast<std::size_t>(start + bound(pair, start) > harmless && end_overlap(pair, motion) > harmless);
        }, std::plus()) == 0;
    }
    return touching_among(body_.pairs()) == touching_among(chosen_);  // a new list holds the chosen as well
}

void Candidates::turn_to_nodes(const RigidClusters& clusters) {
    if (sticking_.empty()) return;
    std::vector<Pair> pairs;
    std::vector<PairStep> steps;
    for (const RigidClusters::NodePair& row : clusters.node_pairs(pairs_)) {
        PairStep step = steps_[row.row];
        if (row.reversed) step.vector = -step.vector;
        step.branch = pair_vector(body_.box(), clusters.places(), row.pair);
        pairs.push_back(row.pair);
        steps.push_back(step);
    }
    pairs_ = std::move(pairs);
    steps_ = std::move(steps);
}

}  // namespace kiln::sintering
