// packing.cpp: from random points to a green body at exactly the required relative density.
#include "packing/packing.h"

#include <cmath>
#include <numeric>

#include "core/neighbours.h"
#include "core/spatial_order.h"

namespace kiln::packing {

namespace {

constexpr double curve_cells = 1 << 20;  // along the longest edge: so many that hardly two particles share a cell

/// Box with its origin at zero and the edges in the required ratio, in which solid (m3) has the relative density.
Box box_for(const std::array<double, 3>& aspect, double solid, double density) {
    Box box;
    const Vec3 edges(aspect[0], aspect[1], aspect[2]);
    box.lengths = std::cbrt(solid / density / edges.prod()) * edges;
    return box;
}

/// The rows ordered along a space-filling curve.
Particles along_curve(const Particles& particles, const Box& box) {
    return take_rows(particles, spatial_order(box, particles.position, box.lengths.maxCoeff() / curve_cells));
}

/// Points without correlation in a box of the given density (relative density, spheres that overlap counted twice).
State random_state(const PackingOptions& options, double density) {
    Random random(options.seed);
    State state;
    Particles& particles = state.particles;
    particles.radius = draw_radii(options.distribution, static_cast<std::size_t>(options.particles), random);
    particles.id.resize(particles.size());
    particles.material.assign(particles.size(), 0);
    state.box = box_for(options.aspect, particle_volume(particles), density);
    for (std::size_t row = 0; row < particles.size(); ++row) {
        Vec3 position;
        for (int axis = 0; axis < 3; ++axis) position[axis] = state.box.lengths[axis] * random.uniform();
        particles.position.push_back(position);
    }
    particles = along_curve(particles, state.box);
    return state;
}

/// Brings the box to a density with all distances between centres scaled alike, radii unchanged.
void scale_to(State& state, const PackingOptions& options, double density) {
    const Box box = box_for(options.aspect, particle_volume(state.particles), density);
    const Vec3 factor = box.lengths.cwiseQuotient(state.box.lengths);
    for (Vec3& position : state.particles.position) position = box.wrap(position.cwiseProduct(factor));
    state.box = box;
}

std::string rounded(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.3g", value);
    return text;
}

/// Throws the Error that says how far the relaxation came.
void check_relaxed(const PackingOptions& options, const Relaxation& relaxation) {
    if (relaxation.finished) return;
    const std::string steps = std::to_string(relaxation.steps) + " steps";
    const std::string when = (relaxation.jammed ? "jammed after " : "after ") + steps;
    if (options.method == Method::soft)
        throw Error("relative density " + rounded(options.density) + ": " + when + " the mean overlap is " +
                    rounded(relaxation.mean_overlap) + " of the radii, above the required " + rounded(options.mean_overlap));
    // Lengths larger by 1/(1 - largest overlap ratio) would part all spheres.
    const double reached = options.density * std::pow(1.0 - relaxation.max_overlap, 3);
    throw Error("relative density " + rounded(options.density) + ": " + when + " spheres still overlap by up to " +
                rounded(relaxation.max_overlap) + " of their radii; about " + rounded(reached) + " can be reached without");
}

}  // namespace

State pack(const PackingOptions& options, const StopRequest& stop, const std::function<void(const Relaxation&)>& progress) {
    const bool soft = options.method == Method::soft;
    if (options.method == Method::loose && options.compact_to) throw Error("a loose packing is not compacted; affine ones are");
    if (options.method == Method::affine && !options.compact_to)
        throw Error("an affine packing requires the density to compact to");
    State state = random_state(options, soft ? options.density : options.density / std::pow(1.0 + options.swell, 3));
    RelaxationOptions required;
    required.damping = options.damping;
    if (soft) required.mean_overlap = options.mean_overlap;
    check_relaxed(options, relax(state.box, state.particles.radius, state.particles.position, required, stop, progress));
    scale_to(state, options, options.compact_to.value_or(options.density));
    state.particles = along_curve(state.particles, state.box);
    std::iota(state.particles.id.begin(), state.particles.id.end(), std::int64_t{0});
    return state;
}

}  // namespace kiln::packing
