// fixture.h: the three cylinders of the test, what they can touch, and how the deflection is read.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "mechanics/contact_problem.h"
#include "bending/options.h"
#include "bending/specimen.h"

namespace kiln::bending {

/// Cylinders along y; lengths in m.
struct Fixture {
    double span, radius;
    double middle;    // x of the punch's axis
    double centre_y;  // of the bar
};

/// Spans and radii of the options, or their defaults. Throws Error if the span is not shorter than the bar, if it is below twice
/// the height and the options do not allow that, or if the bar's largest piece does not reach from support to support.
Fixture place_fixture(const Specimen& specimen, const Options& options);

/// True if particles (rows of the state) reach from support to support.
bool reaches_supports(const Specimen& specimen, const Fixture& fixture, std::span<const std::int32_t> rows);

/// Deflection at which unloading begins, m: the option's, or its default.
double max_deflection_of(const Specimen& specimen, const Options& options);

/// Force over deflection if the bar were as stiff as the solid's share of its volume, N/m: where searches begin.
double estimated_stiffness(const Specimen& specimen, const Fixture& fixture);

/// Force at which unloading begins, N: the option's, or about that of its deflection.
double expected_force(const Specimen& specimen, const Fixture& fixture, const Options& options);

/// Particles that a cylinder can come to touch; each cylinder just touches its nearest one. Throws Error if one finds none.
mechanics::Tooling find_contacts(const Specimen& specimen, const Fixture& fixture);

/// Distance between the resultants of the two supports' forces along z (N, one a contact, on the particle), m; none if one
/// support carries nothing.
std::optional<double> held_span(const Specimen& specimen, const mechanics::Tooling& tooling, std::span<const Vec3> force);

/// Horizontal force of the supports that presses the bar together along x, their mean, N: that of friction.
double thrust(const mechanics::Tooling& tooling, std::span<const Vec3> force);

/// Reads a deflection from the displacements of nodes, m: the lower face under the load, downwards, against the mean of the
/// cross-sections above the two supports. Local dents of the contacts hardly enter, rigid motions not at all.
class Gauge {
   public:
    Gauge(const Specimen& specimen, const Fixture& fixture);
    double read(const mechanics::Vector& displacement) const;

   private:
    struct Weight {
        std::int32_t node;
        double weight;
    };
    std::vector<Weight> weights_;
};

}  // namespace kiln::bending
