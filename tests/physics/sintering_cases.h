// sintering_cases.h: packings, settings and closed forms that the tests of sintering share.
#pragma once

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/neighbours.h"
#include "sintering/explicit_sintering.h"
#include "sintering/implicit_sintering.h"
#include "physics/diffusion.h"
#include "physics/materials.h"
#include "tests/physics/relative.h"
#include "packing/packing.h"

namespace sintering_cases {

using namespace kiln;
using test::deviation;

inline constexpr double temperature = 1473.15;  // K
inline constexpr double radius = 50e-9;         // of a particle, m
inline constexpr double endless = std::numeric_limits<double>::infinity();

inline double diffusion() { return physics::diffusion_parameter_of(physics::builtin_material("alumina"), temperature); }
inline double surface_energy() { return *physics::builtin_material("alumina").surface_energy; }

inline State state_of(const std::vector<Vec3>& positions, const std::vector<double>& radii, const Vec3& box, bool periodic) {
    State state;
    state.materials = {physics::builtin_material("alumina")};
    state.box.lengths = box;
    state.box.periodic = {periodic, periodic, periodic};
    state.particles.position = positions;
    state.particles.radius = radii;
    state.particles.material.assign(radii.size(), 0);
    for (std::size_t row = 0; row < radii.size(); ++row) state.particles.id.push_back(static_cast<std::int64_t>(row) + 1);
    return state;
}

inline sintering::SinteringSettings settings(double tolerance = 1e-3) {
    sintering::SinteringSettings wanted;
    wanted.schedule = physics::Schedule::hold(temperature);
    wanted.tolerance = tolerance;
    wanted.solver_tolerance = 1e-7;
    return wanted;
}

/// Sinters until the time and gives the state there.
inline State sintered(State state, double time, const sintering::SinteringSettings& wanted = settings()) {
    sintering::ImplicitSintering sintering(std::move(state), wanted);
    while (sintering.time() < time) {
        const sintering::StepRecord record = sintering.advance(time, endless);
        REQUIRE(record.converged);
        REQUIRE(std::isfinite(record.relative_density));
    }
    return sintering.state();
}

/// Face-centred cubic cell of touching spheres, their overlap h = 2 R s.
inline State face_centred_cell(double s) {
    const double cell = 2.0 * radius * (1.0 - s) / std::sqrt(0.5);
    std::vector<Vec3> positions;
    for (const Vec3& site : {Vec3(0, 0, 0), Vec3(0.5, 0.5, 0), Vec3(0.5, 0, 0.5), Vec3(0, 0.5, 0.5)})
        positions.push_back(site * cell);
    return state_of(positions, std::vector<double>(4, radius), Vec3::Constant(cell), true);
}

inline double distance(const State& state, std::size_t a, std::size_t b) {
    return (state.particles.position[b] - state.particles.position[a]).norm();
}

/// Overlap of a pair by the pair law of Eq. 1: h^3 = h0^3 + 3.375 Delta gamma t/R*.
inline double pair_law(double overlap, double reduced, double time) {
    return std::cbrt(overlap * overlap * overlap + 3.375 * diffusion() * surface_energy() * time / reduced);
}

inline State random_packing(std::int64_t count, double density, double scale, std::uint64_t seed = 5) {
    packing::PackingOptions wanted;
    wanted.particles = count;
    wanted.density = density;
    wanted.seed = seed;
    State state = packing::pack(wanted);
    state.materials = {physics::builtin_material("alumina")};
    state.box.lengths *= scale;
    for (Vec3& position : state.particles.position) position *= scale;
    for (double& each : state.particles.radius) each *= scale;
    return state;
}

}  // namespace sintering_cases
