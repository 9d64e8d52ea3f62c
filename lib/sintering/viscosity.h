// viscosity.h: what a packing is as a continuum while it sinters: sintering stress, bulk and shear viscosity.
#pragma once

#include <array>

#include "core/state.h"
#include "core/stop.h"
#include "physics/sinter_contact.h"

namespace kiln::sintering {

/// Linear response of a periodic packing at rest: stress = sintering stress + viscosity * strain rate, along the axes of the box.
struct ViscousResponse {
    Vec3 sintering_stress = Vec3::Zero();                  // Pa, tension that holds the box still; zero along a locked axis
    Eigen::Matrix3d viscosity = Eigen::Matrix3d::Zero();   // Pa s, stress along a row's axis for a strain rate along a column's;
                                                           // infinite along a locked axis
    int conjugate_gradients = 0;
    bool converged = true;                           // of the motions, by their forces in double precision
    std::array<bool, 3> locked{false, false, false};  // axes that a rigid cluster spans: along them the box does not flow

    bool flows() const { return !locked[0] && !locked[1] && !locked[2]; }

    double mean_sintering_stress() const { return sintering_stress.mean(); }       // Pa
    double bulk_viscosity() const { return viscosity.sum() / 9.0; }                // Pa s
    /// Of the isotropic average of the entries along the axes, Pa s.
    double shear_viscosity() const {
        const double along = viscosity.trace() / 3.0, across = (viscosity.sum() - viscosity.trace()) / 6.0;
        return 0.5 * (along - across);
    }
};

/// Imposes a unit strain rate along each axis with the particles free to move in the box, at the state's contacts.
///
/// A contact that has just formed has no viscosity, and the response at that instant no meaning: overlaps count as at least 1e-3
/// R*. temperature: K; the sintering stress depends on it only through the ratios of several materials' diffusion. Contacts that do
/// not diffuse, or by less than Kinetics::rigid_fraction of the fastest, hold their particles together. stop: asked
/// between iterations. Throws Interrupted if it says so, and Error where an axis is not periodic.
ViscousResponse viscous_response(const State& state, const physics::ContactConstants& constants, double temperature,
                                 const StopRequest& stop = {});

/// Viscosity above which a body does not flow in any sense that can be measured, Pa s: under 1 GPa by less than 1e-7 in a year.
inline constexpr double max_meaningful_viscosity = 1e24;

}  // namespace kiln::sintering
