// relaxation.cpp: neighbour lists with a margin, accelerations gathered by particle, semi-implicit steps.
#include "packing/relaxation.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/grouping.h"
#include "core/neighbours.h"
#include "core/parallel.h"

namespace kiln::packing {

namespace {

constexpr double margin = 0.3;     // of its radius that a particle may move before the lists are made anew
constexpr double time_step = 0.2;  // the unit of time is that of h'' = -2 h for the overlap h of a pair
constexpr double at_rest = 1e-4;   // net force over contact force, both root mean square, below which the packing counts as jammed
constexpr std::size_t chunk = 1024;  // particles whose sums are formed together; fixed, so that sums do not depend on threads

struct Neighbour {
    std::int32_t row;
    Image image;
};

/// Neighbours of every particle, each pair under both its particles.
struct Lists {
    Grouping<Neighbour> neighbours;  // of each particle
    std::vector<Vec3> position;  // m, when the lists were made
};

struct Sums {
    std::size_t touches = 0;  // each contact counts twice
    double max_overlap = 0.0, overlap = 0.0;
    double contact_square = 0.0, net_square = 0.0;  // m2, squared accelerations

    void add(const Sums& other) {
        touches += other.touches;
        max_overlap = std::max(max_overlap, other.max_overlap);
        overlap += other.overlap;
        contact_square += other.contact_square;
        net_square += other.net_square;
    }
};

double cube(double x) { return x * x * x; }

void make_lists(const Box& box, std::span<const double> radius, std::vector<Vec3>& position, Lists& lists) {
    std::vector<double> reach(radius.begin(), radius.end());
    for (double& each : reach) each *= 1.0 + margin;
    for (Vec3& each : position) each = box.wrap(each);
    const std::vector<Pair> pairs = find_pairs(box, position, reach);
    const auto opposite = [](std::int8_t image) { return static_cast<std::int8_t>(-image); };
    lists.neighbours = group_by<Neighbour>(radius.size(), [&](const auto& visit) {
        for (const Pair& pair : pairs) {
            visit(static_cast<std::size_t>(pair.i), Neighbour{pair.j, pair.image});
            visit(static_cast<std::size_t>(pair.j),
                  Neighbour{pair.i, {opposite(pair.image[0]), opposite(pair.image[1]), opposite(pair.image[2])}});
        }
    });
    lists.position = position;
}

/// Acceleration of one particle (m per squared unit of time); its contacts are added to the sums.
Vec3 acceleration_of(std::size_t row, const Box& box, std::span<const double> radius, std::span<const Vec3> position,
                     const Lists& lists, Sums& sums) {
    Vec3 net = Vec3::Zero();
    const double mass = cube(radius[row]);
    for (const Neighbour& neighbour : lists.neighbours.of(row)) {
        const auto other = static_cast<std::size_t>(neighbour.row);
        const double reach = radius[row] + radius[other];
        const Vec3 apart = position[other] + box.shift(neighbour.image) - position[row];
        const double square = apart.squaredNorm();
        if (square >= reach * reach) continue;
        const double distance = std::sqrt(square);
        const double overlap = reach - distance;
        const double other_mass = cube(radius[other]);
        const double push = 2.0 * other_mass / (mass + other_mass) * overlap;
        net -= push / distance * apart;
        ++sums.touches;
        sums.overlap += overlap / reach;
        sums.max_overlap = std::max(sums.max_overlap, overlap / reach);
        sums.contact_square += push * push;
    }
    sums.net_square += net.squaredNorm();
    return net;
}

Sums accelerate(const Box& box, std::span<const double> radius, std::span<const Vec3> position, const Lists& lists,
                std::vector<Vec3>& acceleration) {
    std::vector<Sums> partial((radius.size() + chunk - 1) / chunk);
    for_chunks(partial.size(), [&](std::size_t part) {
        for (std::size_t row = part * chunk; row < std::min((part + 1) * chunk, radius.size()); ++row)
            acceleration[row] = acceleration_of(row, box, radius, position, lists, partial[part]);
    }, worth_threads / chunk);
    Sums sums;
    for (const Sums& each : partial) sums.add(each);
    return sums;
}

/// One semi-implicit step. damping: per unit of time. Returns the largest way gone since the lists were made, in the particle's
/// radii.
double step(std::span<const double> radius, std::span<const Vec3> acceleration, double damping, const Lists& lists,
            std::vector<Vec3>& velocity, std::vector<Vec3>& position) {
    const double kept = 1.0 / (1.0 + damping * time_step);
    return std::sqrt(greatest_of_rows(radius.size(), 0.0, [&](std::size_t row) {
        velocity[row] = kept * (velocity[row] + time_step * acceleration[row]);
        position[row] += time_step * velocity[row];
        return (position[row] - lists.position[row]).squaredNorm() / (radius[row] * radius[row]);
    }));
}

}  // namespace

Relaxation relax(const Box& box, std::span<const double> radius, std::vector<Vec3>& position, const RelaxationOptions& options,
                 const StopRequest& stop, const std::function<void(const Relaxation&)>& progress) {
    const double damping = 2.0 * std::numbers::sqrt2 * options.damping;  // critical damping of h'' = -2 h
    Lists lists;
    make_lists(box, radius, position, lists);
    std::vector<Vec3> velocity(position.size(), Vec3::Zero()), acceleration(position.size());
    Relaxation now;
    for (;; ++now.steps) {
        const Sums sums = accelerate(box, radius, position, lists, acceleration);
        now.contacts = sums.touches / 2;
        now.max_overlap = sums.max_overlap;
        now.mean_overlap = sums.touches > 0 ? sums.overlap / static_cast<double>(sums.touches) : 0.0;
        now.finished = now.max_overlap <= options.max_overlap || now.mean_overlap <= options.mean_overlap;
        now.jammed = !now.finished && sums.net_square <= at_rest * at_rest * sums.contact_square;
        if (progress) progress(now);
        if (now.finished || now.jammed || now.steps == options.max_steps) return now;
        throw_if_stopped(stop);
        if (step(radius, acceleration, damping, lists, velocity, position) > margin) make_lists(box, radius, position, lists);
    }
}

}  // namespace kiln::packing
