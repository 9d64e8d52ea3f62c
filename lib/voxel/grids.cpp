// grids.cpp: from a state to tensors on several grids.
#include "voxel/grids.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "physics/materials.h"
#include "voxel/geometry.h"

namespace kiln::voxel {

namespace {

constexpr std::size_t max_phases = 254;

double nodes_of(const std::array<std::size_t, 3>& count) { return static_cast<double>(count[0] * count[1] * count[2]); }

std::string text_of(const std::array<std::size_t, 3>& count) {
    return std::to_string(count[0]) + "x" + std::to_string(count[1]) + "x" + std::to_string(count[2]);
}

}  // namespace

Phases<Solid> elastic_phases(const State& state) {
    if (state.materials.size() > max_phases) throw Error("a voxel can be of 254 materials, and the state has more");
    Phases<Solid> phases;
    for (const Material& material : state.materials) {
        const double young = physics::required(material.young_modulus, material, "young_modulus");
        phases.media.push_back(solid(young, physics::required(material.poisson_ratio, material, "poisson_ratio")));
    }
    for (const std::int32_t material : state.particles.material)
        phases.of_particle.push_back(static_cast<std::uint8_t>(material + 1));
    return phases;
}

Phases<Conductor> conducting_phases(const State& state, double conductivity) {
    return {std::vector<std::uint8_t>(state.particles.size(), 1), {Conductor{conductivity}}};
}

std::vector<std::array<std::size_t, 3>> grids_of(const State& state, std::span<const double> voxels) {
    if (state.particles.size() == 0) throw Error("the state has no particles");
    std::vector<double> ascending(voxels.begin(), voxels.end());
    std::sort(ascending.begin(), ascending.end());
    std::vector<std::array<std::size_t, 3>> grids;
    for (const double each : ascending) {
        grids.push_back(grid_counts(state.box, mean_radius(state.particles), each));
        if (grids.size() > 1 && !(nodes_of(grids.back()) > nodes_of(grids[grids.size() - 2])))
            throw Error("two of the grids are the same, " + text_of(grids.back()) + " voxels; ask for numbers further apart");
    }
    return grids;
}

template <typename Medium>
OnGrid of_image(Image image, const std::vector<Medium>& media, double tolerance, const Watch& watch, Solutions* solutions) {
    OnGrid result;
    result.count = image.count;
    result.union_fraction = image.solid_fraction();
    const Percolation percolation = remove_loose(image);
    result.loose_fraction = static_cast<double>(percolation.loose) / static_cast<double>(image.voxels());
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (!percolation.along[axis])
            throw Error("on a grid of " + text_of(image.count) + " voxels the solid does not reach round the box along " +
                        "xyz"[axis] + ", so nothing holds it together there");
    result.found = homogenise(image, media, tolerance, watch, solutions);
    return result;
}

template <typename Medium>
std::vector<OnGrid> on_grids(const State& state, const Phases<Medium>& phases,
                             std::span<const std::array<std::size_t, 3>> grids, double tolerance, const Watch& watch) {
    double all = 0.0, done = 0.0;
    for (const auto& count : grids) all += nodes_of(count);
    std::vector<OnGrid> results;
    Solutions solutions;
    for (const auto& count : grids) {
        const Watch part{watch.stop, [&](double fraction) {
                             if (watch.progress) watch.progress((done + fraction * nodes_of(count)) / all);
                         }};
        Raster raster = rasterise(state, count, phases.of_particle);
        const double edge = std::cbrt(raster.image.edges.prod());
        results.push_back(of_image(std::move(raster.image), phases.media, tolerance, part, &solutions));
        results.back().union_fraction = raster.union_fraction;
        results.back().voxels = mean_radius(state.particles) / edge;
        done += nodes_of(count);
    }
    return results;
}

template std::vector<OnGrid> on_grids(const State&, const Phases<Solid>&, std::span<const std::array<std::size_t, 3>>, double,
                                      const Watch&);
template std::vector<OnGrid> on_grids(const State&, const Phases<Conductor>&, std::span<const std::array<std::size_t, 3>>, double,
                                      const Watch&);
template OnGrid of_image(Image, const std::vector<Solid>&, double, const Watch&, Solutions*);
template OnGrid of_image(Image, const std::vector<Conductor>&, double, const Watch&, Solutions*);

}  // namespace kiln::voxel
