// union_volume.cpp: lenses and rings in closed form, less what points find shared in them.
#include "bonding/union_volume.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/parallel.h"
#include "core/state.h"
#include "physics/neck.h"

namespace kiln::bonding {

namespace {

using std::numbers::pi;

constexpr std::size_t all_points = 1'500'000;      // of all ends, at least
constexpr std::size_t fewest_points = 2;           // of an end
constexpr std::size_t max_points = 4096;          // the same
constexpr std::size_t particles_of_a_chunk = 256;  // fixed, whatever the number of threads
constexpr double reach_to_spare = 1.02;            // lists of neighbours serve for necks a little larger

std::size_t at(std::int32_t row) { return static_cast<std::size_t>(row); }

double square(double value) { return value * value; }

/// Point of Roberts' R3 sequence: multiples of 1/g, 1/g2, 1/g3 modulo 1, where g4 = g + 1.
struct Sample {
    double depth, section, angle;  // 0 to 1
};

Sample sample(std::size_t index) {
    constexpr double g = 1.2207440846057596;
    const auto fraction = [n = static_cast<double>(index)](double step) {
        const double multiple = 0.5 + n * step;
        return multiple - std::floor(multiple);
    };
    return {fraction(1.0 / g), fraction(1.0 / (g * g)), fraction(1.0 / (g * g * g))};
}

/// Points of an end: the mean of what they find, and its variance.
class Mean {
   public:
    void add(double value) {
        sum_ += value;
        squares_ += value * value;
        ++count_;
    }
    double value() const { return sum_ / static_cast<double>(count_); }
    double variance() const {
        const auto n = static_cast<double>(count_);
        return std::max(0.0, squares_ / n - square(value())) / (n - 1.0);
    }

   private:
    double sum_ = 0.0, squares_ = 0.0;
    std::size_t count_ = 0;
};

/// Two unit vectors across a direction.
struct Across {
    explicit Across(const Vec3& direction) : first(direction.unitOrthogonal()), second(direction.cross(first)) {}
    Vec3 at(double radius, double turns) const {
        return radius * (std::cos(2.0 * pi * turns) * first + std::sin(2.0 * pi * turns) * second);
    }
    Vec3 first, second;
};

/// Ends, each with a particle's row as its key, from the pairs.
template <typename End, typename Visit>
void visit_ends(const Box& box, std::span<const Vec3> position, std::span<const double> radius, std::span<const Pair> pairs,
                const Visit& visit) {
    for (std::size_t index = 0; index < pairs.size(); ++index) {
        const std::size_t i = at(pairs[index].i), j = at(pairs[index].j);
        const Vec3 vector = pair_vector(box, position, pairs[index]);
        const double distance = vector.norm();
        const Vec3 direction = vector / distance;
        visit(i, End{direction, distance, radius[j], physics::meeting_plane(distance, radius[i], radius[j]), index});
        visit(j, End{-direction, distance, radius[i], physics::meeting_plane(distance, radius[j], radius[i]), index});
    }
}

}  // namespace

UnionVolume::UnionVolume(const Box& box, std::span<const Vec3> position, std::span<const double> radius,
                         std::span<const Pair> pairs)
    : box_(box),
      position_(position),
      radius_(radius),
      ends_(group_by<End>(radius.size(),
                          [&](const auto& visit) { visit_ends<End>(box, position, radius, pairs, visit); })),
      half_(ends_.items.size()),
      swollen_(radius.begin(), radius.end()),
      points_(std::clamp(all_points / std::max<std::size_t>(1, ends_.items.size()), fewest_points, max_points)) {
    find_near(radius);
    const Part lenses = sum_over_ends([this](std::size_t row, std::size_t end) { return lens(row, end); });
    double all = 0.0;
    for (const double each : radius) all += sphere_volume(each);
    spheres_ = {all - lenses.volume, std::sqrt(lenses.variance)};
}

void UnionVolume::Part::operator+=(const Part& other) {
    volume += other.volume;
    variance += other.variance;
}

template <typename OfEnd>
UnionVolume::Part UnionVolume::sum_over_ends(const OfEnd& of_end) const {
    const std::size_t rows = radius_.size();
    return sum_chunks((rows + particles_of_a_chunk - 1) / particles_of_a_chunk, Part(), [&](std::size_t chunk) {
        Part sum;
        for (std::size_t row = chunk * particles_of_a_chunk; row < std::min(rows, (chunk + 1) * particles_of_a_chunk); ++row)
            for (std::size_t end = ends_.begin[row]; end < ends_.begin[row + 1]; ++end) sum += of_end(row, end);
        return sum;
    });
}

/// Lists of the particles, images included, that come within each other's reach.
void UnionVolume::find_near(std::span<const double> reach) {
    reach_.resize(reach.size());
    std::ranges::transform(reach, reach_.begin(), [](double each) { return reach_to_spare * each; });
    const std::vector<Pair> pairs = find_pairs(box_, position_, reach_);
    near_ = group_by<Near>(radius_.size(), [&](const auto& visit) {
        for (const Pair& pair : pairs) {
            const Vec3 vector = pair_vector(box_, position_, pair);
            visit(at(pair.i), Near{vector, pair.j});
            visit(at(pair.j), Near{-vector, pair.i});
        }
    });
}

/// Of the particles near one, those whose sphere or necks may reach into a ball about a place relative to it: few, also where one
/// has thousands of neighbours.
void UnionVolume::find_reaching(std::size_t row, const Vec3& centre, double size, std::vector<Near>& reaching) const {
    reaching.clear();
    for (const Near& near : near_.of(row))
        if ((near.vector - centre).squaredNorm() < square(swollen_[at(near.row)] + size)) reaching.push_back(near);
}

/// What of the volume at a point in a half neck of a particle is this neck's: nothing in a sphere, else an equal part of what all
/// necks there have. The point is relative to the particle's centre.
double UnionVolume::share_of_ring(std::size_t row, std::span<const Near> reaching, const Vec3& point) const {
    for (const Near& near : reaching)
        if ((point - near.vector).squaredNorm() < square(radius_[at(near.row)])) return 0.0;
    std::size_t necks = 0;
    const auto count = [&](std::size_t particle, const Vec3& place) {
        const double distance2 = place.squaredNorm();
        if (distance2 > square(swollen_[particle])) return;
        for (std::size_t end = ends_.begin[particle]; end < ends_.begin[particle + 1]; ++end) {
            const double along = place.dot(half_[end].direction);
            necks += along > half_[end].begin && along < half_[end].end && distance2 - along * along < half_[end].radius2;
        }
    };
    count(row, point);
    for (const Near& near : reaching) count(at(near.row), point - near.vector);
    return 1.0 / static_cast<double>(std::max<std::size_t>(1, necks));
}

/// Of the cap that the other sphere of an end has on this side of the plane, what counts twice: where k spheres overlap, k - 1 of
/// them too many, 2/k for each of their k (k - 1)/2 pairs.
UnionVolume::Part UnionVolume::lens(std::size_t row, std::size_t index) const {
    const End& end = ends_.items[index];
    const double R = end.other_radius, height = std::clamp(R - (end.distance - end.plane), 0.0, 2.0 * R);
    if (height == 0.0) return {};
    const double volume = pi * square(height) * (R - height / 3.0);
    const Vec3 pole = (end.distance - R) * end.direction;
    std::vector<Near> reaching;
    find_reaching(row, pole, std::sqrt(2.0 * R * height), reaching);
    if (reaching.size() < 2) return {volume, 0.0};
    const Across across(end.direction);
    Mean triple;
    for (std::size_t k = 0; k < points_; ++k) {
        const Sample at_point = sample(index * points_ + k);
        const double from_pole = height * std::sqrt(at_point.depth), along = R - from_pole;
        const double section = std::sqrt(at_point.section * from_pole * (R + along));
        const Vec3 point = (end.distance - along) * end.direction + across.at(section, at_point.angle);
        double spheres = 1.0;
        for (const Near& near : reaching) spheres += (point - near.vector).squaredNorm() < square(radius_[at(near.row)]);
        triple.add(0.5 * pi * square(height) * (R + along) * (1.0 - 2.0 / std::max(2.0, spheres)));
    }
    return {volume - triple.value(), triple.variance()};
}

/// What half a neck adds outside all spheres, its part where several necks do.
UnionVolume::Part UnionVolume::ring(std::size_t row, std::size_t index) const {
    const HalfNeck& half = half_[index];
    const double width = half.end - half.begin;
    if (!(width > 0.0)) return {};
    const double R = radius_[row], R2 = square(R), gap = std::max(0.0, half.end - R);  // beyond the sphere the neck is a cylinder
    const double volume = pi * (square(width) * (half.end + 2.0 * half.begin) - square(gap) * (half.end + 2.0 * R)) / 3.0;
    std::vector<Near> reaching;
    find_reaching(row, 0.5 * (half.begin + half.end) * half.direction, std::sqrt(0.25 * square(width) + half.radius2), reaching);
    const Across across(half.direction);
    Mean lost;
    for (std::size_t k = 0; k < points_; ++k) {
        const Sample at_point = sample(index * points_ + k);
        const double along = half.begin + width * std::sqrt(at_point.depth);
        const double sphere2 = std::max(0.0, R2 - along * along);
        const double section = std::sqrt(sphere2 + at_point.section * (half.radius2 - sphere2));
        const Vec3 point = along * half.direction + across.at(section, at_point.angle);
        const double section_over_width = along <= R ? along + half.begin : half.radius2 / (along - half.begin);
        lost.add(0.5 * pi * square(width) * section_over_width * (1.0 - share_of_ring(row, reaching, point)));
    }
    return {volume - lost.value(), lost.variance()};
}

VolumeEstimate UnionVolume::with_necks(std::span<const double> neck_radius) {
    bool within = true;
    for (std::size_t row = 0; row < radius_.size(); ++row) {
        swollen_[row] = radius_[row];
        for (std::size_t index = ends_.begin[row]; index < ends_.begin[row + 1]; ++index) {
            const End& end = ends_.items[index];
            const double a = neck_radius[end.pair];
            half_[index] = {end.direction, std::sqrt(std::max(0.0, (radius_[row] - a) * (radius_[row] + a))), end.plane, a * a};
            // A sphere that is sunk into the other beyond its centre has no neck.
            if (end.plane <= 0.0 || end.plane >= end.distance) half_[index].begin = half_[index].end = 0.0;
            if (half_[index].begin < half_[index].end)
                swollen_[row] = std::max(swollen_[row], std::sqrt(square(half_[index].end) + a * a));
        }
        within = within && swollen_[row] <= reach_[row];
    }
    if (!within) find_near(swollen_);
    const Part rings = sum_over_ends([this](std::size_t row, std::size_t end) { return ring(row, end); });
    return {spheres_.value + rings.volume, std::hypot(spheres_.error, std::sqrt(rings.variance))};
}

}  // namespace kiln::bonding
