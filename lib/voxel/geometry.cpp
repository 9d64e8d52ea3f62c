// geometry.cpp: spheres and cylinders painted plane by plane into a periodic image.
#include "voxel/geometry.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <tuple>

#include "core/grouping.h"
#include "core/neighbours.h"
#include "core/parallel.h"
#include "linalg/line_transform.h"

namespace kiln::voxel {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double parallel = 1e-12;  // a direction whose component along x is less is one across it

/// Values of x between which something is solid on a row; none where low > high.
struct Interval {
    double low = -infinity, high = infinity;

    void cut(double from, double to) {
        low = std::max(low, from);
        high = std::min(high, to);
    }
    bool empty() const { return low > high; }
};

constexpr Interval nowhere{1.0, 0.0};

/// Where from <= slope x + offset <= to.
Interval between(double slope, double offset, double from, double to) {
    if (std::abs(slope) < parallel) return offset >= from && offset <= to ? Interval() : nowhere;
    const double a = (from - offset) / slope, b = (to - offset) / slope;
    return {std::min(a, b), std::max(a, b)};
}

/// A sphere (no second particle) or the cylinder between two particles. Centres are measured from the box's origin.
struct Body {
    Vec3 centre, vector = Vec3::Zero();
    double radius = 0.0;
    std::int32_t first = 0, second = -1;

    /// The middle of its bounding box, and half the edges.
    Vec3 middle() const { return centre + 0.5 * vector; }
    Vec3 reach() const { return 0.5 * vector.cwiseAbs() + Vec3::Constant(radius); }

    /// Where a row at (y, z) from the first centre lies inside, x from the first centre.
    Interval inside(double y, double z) const {
        const double square = radius * radius;
        if (second < 0) {
            const double rest = square - y * y - z * z;
            return rest >= 0.0 ? Interval{-std::sqrt(rest), std::sqrt(rest)} : nowhere;
        }
        const double length = vector.norm();
        const Vec3 n = vector / length;
        const double along = y * n[1] + z * n[2], across = 1.0 - n[0] * n[0];
        Interval x = between(n[0], along, 0.0, length);
        // Distance from the axis: across x^2 - 2 n_x along x + y^2 + z^2 - along^2 <= radius^2.
        const double rest = square - y * y - z * z + along * along;
        if (across < parallel) return rest >= 0.0 ? x : nowhere;
        const double middle = n[0] * along / across, root = middle * middle + rest / across;
        if (root < 0.0) return nowhere;
        x.cut(middle - std::sqrt(root), middle + std::sqrt(root));
        return x;
    }
};

std::vector<Body> bodies_of(const State& state) {
    std::vector<Body> bodies;
    for (std::size_t i = 0; i < state.particles.size(); ++i) {
        const Vec3 centre = state.particles.position[i] - state.box.origin;
        bodies.push_back({centre, Vec3::Zero(), state.particles.radius[i], static_cast<std::int32_t>(i)});
    }
    for (std::size_t bond = 0; state.bonds && bond < state.bonds->size(); ++bond) {
        const auto [first, second] = state.bonds->pair[bond];
        const Vec3 vector = bond_vector(state, *state.bonds, bond);
        if (!(state.bonds->radius[bond] > 0.0) || !(vector.norm() > 0.0)) continue;
        const Vec3 centre = state.particles.position[static_cast<std::size_t>(first)] - state.box.origin;
        bodies.push_back({centre, vector, state.bonds->radius[bond], first, second});
    }
    return bodies;
}

/// A layer of a sphere that stays open: low <= normal . x - plane <= high, further than the neck from the axis; x from its centre.
struct Gap {
    Vec3 normal;
    double plane, low, high;
    double neck2;  // square of the radius of the neck
};

/// Pairs of particles in one order, with the radius of their bond.
struct BondOfPair {
    Pair pair;
    double radius;
};

auto key_of(const Pair& pair) { return std::make_tuple(pair.i, pair.j, pair.image); }

std::vector<BondOfPair> bonds_by_pair(const State& state) {
    std::vector<BondOfPair> bonds;
    for (std::size_t bond = 0; state.bonds && bond < state.bonds->size(); ++bond) {
        const auto [first, second] = state.bonds->pair[bond];
        const kiln::Image image = state.bonds->image[bond];
        const kiln::Image back{static_cast<std::int8_t>(-image[0]), static_cast<std::int8_t>(-image[1]),
                               static_cast<std::int8_t>(-image[2])};
        bonds.push_back({{first, second, image}, state.bonds->radius[bond]});
        bonds.push_back({{second, first, back}, state.bonds->radius[bond]});
    }
    std::sort(bonds.begin(), bonds.end(), [](const BondOfPair& a, const BondOfPair& b) {
        return key_of(a.pair) != key_of(b.pair) ? key_of(a.pair) < key_of(b.pair) : a.radius > b.radius;
    });
    return bonds;
}

/// Square of the distance from the line of centres at which the gap between two spheres has a width; 0 where it is wider
/// throughout.
double radius2_of_width(double r1, double r2, double length, double width) {
    double inner = 0.0, outer = std::pow(std::min(r1, r2), 2);
    for (int halving = 0; halving < 50; ++halving) {
        const double middle = 0.5 * (inner + outer);
        const bool narrower = length - std::sqrt(r1 * r1 - middle) - std::sqrt(r2 * r2 - middle) < width;
        (narrower ? inner : outer) = middle;
    }
    return inner;
}

/// Gaps of each particle. Half a layer is what a voxel reaches to either side of its middle, so that none lies across the plane;
/// where a grid and a lattice agree the plane may fall between two layers of voxels, and then the first particle's goes.
Grouping<Gap> gaps_of(const State& state, const Vec3& edges) {
    constexpr double rounding = 1e-9, open_width = 0.25;  // of the layer's thickness; see geometry.h
    const Particles& particles = state.particles;
    std::vector<double> reach = particles.radius;
    for (double& each : reach) each += 0.5 * edges.sum();
    const std::vector<Pair> pairs = find_pairs(state.box, particles.position, reach);
    const std::vector<BondOfPair> bonds = bonds_by_pair(state);
    return group_by<Gap>(particles.size(), [&](const auto& visit) {
        for (const Pair& pair : pairs) {
            const Vec3 vector = pair_vector(state.box, particles.position, pair);
            const double length = vector.norm(), r1 = particles.radius[static_cast<std::size_t>(pair.i)];
            const double r2 = particles.radius[static_cast<std::size_t>(pair.j)];
            if (!(length > std::abs(r1 - r2))) continue;  // one inside the other
            const Vec3 normal = vector / length;
            const double plane = 0.5 * (length * length + r1 * r1 - r2 * r2) / length;
            const double half = 0.5 * normal.cwiseAbs().dot(edges);
            double neck2 = length < r1 + r2 ? radius2_of_width(r1, r2, length, 2.0 * open_width * half) : 0.0;
            const auto bond = std::lower_bound(bonds.begin(), bonds.end(), pair, [](const BondOfPair& each, const Pair& wanted) {
                return key_of(each.pair) < key_of(wanted);
            });
            if (bond != bonds.end() && key_of(bond->pair) == key_of(pair)) neck2 = std::max(neck2, bond->radius * bond->radius);
            const double more = half * (1.0 + rounding), less = half * (1.0 - rounding);
            visit(static_cast<std::size_t>(pair.i), Gap{normal, plane, -more, less, neck2});
            visit(static_cast<std::size_t>(pair.j), Gap{-normal, length - plane, -less, more, neck2});
        }
    });
}

/// The first and last voxel whose middle lies between two places, along one axis.
std::array<std::int64_t, 2> voxels_between(double low, double high, double edge) {
    return {static_cast<std::int64_t>(std::ceil(low / edge - 0.5)), static_cast<std::int64_t>(std::floor(high / edge - 0.5))};
}

std::size_t wrapped(std::int64_t index, std::size_t count) {
    const auto period = static_cast<std::int64_t>(count);
    return static_cast<std::size_t>((index % period + period) % period);
}

/// What touches a plane of voxels: a body, and the plane's number before it was wrapped into the box.
struct Touch {
    std::uint32_t body;
    std::int64_t plane;
};

class Painter {
   public:
    Painter(const State& state, Image& image, std::span<const std::uint8_t> phase)
        : particles_(state.particles), image_(image), phase_(phase), bodies_(bodies_of(state)), gaps_(gaps_of(state, image.edges)),
          several_(std::adjacent_find(phase.begin(), phase.end(), std::not_equal_to<>()) != phase.end()) {
        touches_ = group_by<Touch>(image.count[2], [&](const auto& visit) {
            for (std::uint32_t body = 0; body < bodies_.size(); ++body) {
                const double middle = bodies_[body].middle()[2], reach = bodies_[body].reach()[2];
                const auto [low, high] = voxels_between(middle - reach, middle + reach, image.edges[2]);
                for (std::int64_t plane = low; plane <= high; ++plane) visit(wrapped(plane, image.count[2]), Touch{body, plane});
            }
        });
    }

    /// Paints a plane; gives the number of its voxels in the union.
    std::size_t paint_plane(std::size_t plane) const {
        const std::size_t size = image_.count[0] * image_.count[1];
        Canvas canvas{image_.phase.data() + plane * size, std::vector<double>(several_ ? size : 0, infinity), {}};
        for (const Touch& touch : touches_.of(plane)) paint(bodies_[touch.body], touch.plane, canvas);
        std::size_t painted = 0;
        for (std::size_t voxel = 0; voxel < size; ++voxel) {
            painted += canvas.phase[voxel] != 0;
            if (canvas.phase[voxel] == gap) canvas.phase[voxel] = 0;
        }
        return painted;
    }

   private:
    static constexpr std::uint8_t gap = 255;  // in the union, but open

    struct Canvas {
        std::uint8_t* phase;
        std::vector<double> claim;  // of each voxel, the best one so far; where there are several phases
        std::vector<char> open;     // of the voxels of one row of a sphere
    };

    void paint(const Body& body, std::int64_t plane, Canvas& canvas) const {
        const double z = (static_cast<double>(plane) + 0.5) * image_.edges[2] - body.centre[2];
        const double middle = body.middle()[1], reach = body.reach()[1];
        const auto [low, high] = voxels_between(middle - reach, middle + reach, image_.edges[1]);
        for (std::int64_t row = low; row <= high; ++row) {
            const double y = (static_cast<double>(row) + 0.5) * image_.edges[1] - body.centre[1];
            const Interval x = body.inside(y, z);
            if (x.empty()) continue;
            const auto [begin, end] = voxels_between(body.centre[0] + x.low, body.centre[0] + x.high, image_.edges[0]);
            if (end < begin) continue;
            canvas.open.assign(static_cast<std::size_t>(end - begin + 1), 0);
            if (body.second < 0) open_gaps(body, y, z, begin, end, canvas.open);
            const std::size_t first = wrapped(row, image_.count[1]) * image_.count[0];
            for (std::int64_t voxel = begin; voxel <= end; ++voxel)
                paint_voxel(body, Vec3(x_of(voxel, body), y, z), canvas.open[static_cast<std::size_t>(voxel - begin)] != 0,
                            first + wrapped(voxel, image_.count[0]), canvas);
        }
    }

    /// Place of a voxel's middle from the centre of a body.
    double x_of(std::int64_t voxel, const Body& body) const {
        return (static_cast<double>(voxel) + 0.5) * image_.edges[0] - body.centre[0];
    }

    /// Marks the voxels begin .. end of a row of a sphere that lie in one of its gaps.
    void open_gaps(const Body& sphere, double y, double z, std::int64_t begin, std::int64_t end, std::vector<char>& open) const {
        for (const Gap& each : gaps_.of(static_cast<std::size_t>(sphere.first))) {
            const double along = each.normal[1] * y + each.normal[2] * z;
            Interval x = between(each.normal[0], along - each.plane, each.low, each.high);
            x.cut(x_of(begin - 1, sphere), x_of(end + 1, sphere));
            if (x.empty()) continue;
            const auto [first, last] = voxels_between(sphere.centre[0] + x.low, sphere.centre[0] + x.high, image_.edges[0]);
            for (std::int64_t voxel = std::max(first, begin); voxel <= std::min(last, end); ++voxel) {
                const double here = x_of(voxel, sphere), depth = each.normal[0] * here + along;
                if (here * here + y * y + z * z - depth * depth > each.neck2) open[static_cast<std::size_t>(voxel - begin)] = 1;
            }
        }
    }

    void paint_voxel(const Body& body, const Vec3& from_first, bool open, std::size_t place, Canvas& canvas) const {
        std::uint8_t& phase = canvas.phase[place];
        if (open) {
            if (phase == 0) phase = gap;
        } else if (!several_) {
            phase = phase_[0];
        } else {
            claim(body.first, from_first, phase, canvas.claim[place]);
            if (body.second >= 0) claim(body.second, from_first - body.vector, phase, canvas.claim[place]);
        }
    }

    /// Gives a voxel to a particle that it lies `offset` from, if no other has a better claim; of equal ones the first keeps it.
    void claim(std::int32_t particle, const Vec3& offset, std::uint8_t& phase, double& best) const {
        const double radius = particles_.radius[static_cast<std::size_t>(particle)];
        const double claimed = offset.squaredNorm() - radius * radius;
        if (claimed >= best) return;
        best = claimed;
        phase = phase_[static_cast<std::size_t>(particle)];
    }

    const Particles& particles_;
    Image& image_;
    std::span<const std::uint8_t> phase_;
    std::vector<Body> bodies_;
    Grouping<Gap> gaps_;  // of each particle
    bool several_;        // phases
    Grouping<Touch> touches_;  // of each plane
};

/// The number near a count that is quick to transform.
std::size_t nearest_quick(double count) {
    const std::size_t above = linalg::quick_length(static_cast<std::size_t>(std::ceil(count)));
    for (std::size_t below = static_cast<std::size_t>(std::floor(count)); below > 0; --below) {
        if (linalg::quick_length(below) != below) continue;
        return count / static_cast<double>(below) < static_cast<double>(above) / count ? below : above;
    }
    return above;
}

}  // namespace

std::array<std::size_t, 3> grid_counts(const Box& box, double length, double voxels) {
    std::array<std::size_t, 3> counts;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double count = box.lengths[static_cast<Eigen::Index>(axis)] / length * voxels;
        if (!(count < 1e6))
            throw Error("a grid of " + std::to_string(voxels) + " voxels a radius has more than a million along an axis");
        counts[axis] = nearest_quick(count);
    }
    return counts;
}

double mean_radius(const Particles& particles) {
    double sum = 0.0;
    for (const double radius : particles.radius) sum += radius;
    return sum / static_cast<double>(particles.size());
}

Raster rasterise(const State& state, const std::array<std::size_t, 3>& count, std::span<const std::uint8_t> phase) {
    if (!std::all_of(state.box.periodic.begin(), state.box.periodic.end(), [](bool axis) { return axis; }))
        throw Error(
            "the box is not periodic along all axes, and voxels fill a periodic cell only; bend tests bodies with free faces");
    Image image;
    image.count = count;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto index = static_cast<Eigen::Index>(axis);
        image.edges[index] = state.box.lengths[index] / static_cast<double>(count[axis]);
    }
    image.phase.assign(image.voxels(), 0);
    const Painter painter(state, image, phase);
    const std::size_t painted =
        sum_chunks(count[2], std::size_t{0}, [&](std::size_t plane) { return painter.paint_plane(plane); });
    const double fraction = static_cast<double>(painted) / static_cast<double>(image.voxels());
    return {std::move(image), fraction};
}

}  // namespace kiln::voxel
