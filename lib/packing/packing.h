// packing.h: green bodies: random spheres in a periodic box, relaxed and brought to a relative density.
#pragma once

#include <functional>
#include <optional>

#include "core/state.h"
#include "packing/relaxation.h"
#include "packing/size_distribution.h"

namespace kiln::packing {

enum class Method {
    loose,   // relaxed until no spheres overlap, then all lengths shrunk by the swell
    affine,  // loose, then all lengths shrunk to a higher density
    soft,    // relaxed only until the mean overlap has fallen to a required value
};

struct PackingOptions {
    std::int64_t particles = 99000;
    SizeDistribution distribution = Monosize{100e-9};
    Method method = Method::loose;
    double density = 0.43;             // relative density: volume of all spheres over volume of the box
    std::optional<double> compact_to;  // relative density, of affine always, of soft optionally, of loose never
    double swell = 0.01;               // loose, affine: share by which lengths shrink once no spheres overlap
    double mean_overlap = 0.02;        // soft: mean h/(r_i + r_j) of the contacts
    double damping = 0.295;            // of a pair, as a fraction of its critical damping
    std::array<double, 3> aspect{1.0, 1.0, 1.0};
    std::uint64_t seed = 1;
};

/// A packing in a box that is periodic in three axes, its rows ordered along a space-filling curve; one material, none named yet.
/// progress sees each step of the relaxation. Throws Error where compact_to does not fit the method or the density cannot be
/// reached, and Interrupted.
State pack(const PackingOptions& options, const StopRequest& stop = {},
           const std::function<void(const Relaxation&)>& progress = {});

}  // namespace kiln::packing
