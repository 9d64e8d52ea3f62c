// result.cpp: where all methods begin, and what the contacts of an equilibrium say.
#include "bending/result.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <optional>
#include <sstream>

#include "analysis/slenderness.h"
#include "bending/seating.h"
#include "physics/bending.h"

namespace kiln::bending {

namespace {

constexpr double large_roll = 0.1;           // rad, at rest: the section that bends is no longer the one that was cut
constexpr double large_tilt_error = 0.1;     // of the deflection: heights that small rotations neglect; forces change by less
constexpr double large_energy_error = 5e-3;  // of the energy stored, in a test to failure
constexpr double large_step_error = 0.05;    // the same, of levels that only --points can bring nearer to each other
constexpr double large_damping = 0.01;       // of the energy stored at the peak, in a cycle

/// A number of two digits for a sentence.
std::string digits(double number) {
    std::ostringstream words;
    words << std::setprecision(2) << number;
    return words.str();
}

}  // namespace

Result prepare(State state, const Options& options) {
    Result result;
    result.specimen = cut_specimen(std::move(state), options.model);
    result.fixture = place_fixture(result.specimen, options);
    seat_bar(result.specimen, result.fixture, options);
    result.curve.push_back({0.0, 0.0, 0.0});
    return result;
}

void read_contacts(Result& result, const mechanics::Tooling& tooling, const mechanics::Equilibrium& equilibrium) {
    const std::vector<Vec3>& forces = equilibrium.contact_force;
    result.contacts =
        static_cast<std::size_t>(std::ranges::count_if(forces, [](const Vec3& force) { return force != Vec3::Zero(); }));
    result.closed_gaps = equilibrium.closed_gaps;
    const std::optional<double> held = held_span(result.specimen, tooling, forces);
    result.on_both_supports = held.has_value();
    result.held_span = held.value_or(result.fixture.span);
    result.thrust = thrust(tooling, forces);
}

double mean_turn(const mechanics::BondNetwork& network, const linalg::Vector& displacement) {
    double about_x = 0.0, about_y = 0.0;
    for (const linalg::Vec6& each : displacement) {
        about_x += each[3];
        about_y += each[4];
    }
    return std::hypot(about_x, about_y) / static_cast<double>(displacement.size()) / network.rotation_length;
}

void add_warnings(Result& result, const Options& options) {
    std::vector<std::string>& warnings = result.warnings;
    const Specimen& specimen = result.specimen;
    const double span = result.fixture.span, height = specimen.size[2];
    const double correction = physics::shear_correction(height, span, specimen.poisson_ratio);
    if (const auto sentence = analysis::short_bar_warning(span, height, correction)) warnings.push_back(*sentence);
    const double roll = result.specimen.turn.norm();
    if (roll > large_roll) {
        warnings.push_back("the bar rolls by " + digits(roll) +
                           " rad before it rests on its cylinders, so it does not bend about the axis of its section: it is too "
                           "few particles across");
    }
    if (!result.on_both_supports) {
        warnings.push_back(
            "at the largest force the bar lies on one support only, wedged by friction or about to part; effective_span is the "
            "nominal one");
    }
    double deflection = 0.0;
    for (const Point& point : result.curve) deflection = std::max(deflection, std::abs(point.deflection));
    const double neglected = 0.5 * result.tilt * result.tilt * result.specimen.size[2];
    if (options.method == Method::equilibria && neglected > large_tilt_error * deflection) {
        warnings.push_back("the bar turns by " + digits(result.tilt) +
                           " rad on its cylinders under the load, more than small displacements describe; --method dynamic "
                           "follows it, and may differ");
    }
    if (options.method == Method::motion) {
        const double stored = result.peak.bond_energy + result.peak.contact_energy;
        const double damped = result.dynamic.energy.damping / options.cycles / stored;
        if (damped > large_damping) {
            warnings.push_back("damping takes " + digits(100.0 * damped) +
                               " % of the energy stored in each cycle, so the forces are not those of --method static; a lower "
                               "--punch-velocity brings them nearer");
        }
    }
    if (result.energy_error > (options.to_failure() ? large_energy_error : large_step_error)) {
        warnings.push_back("the work of the punch and the energy found differ by " + digits(100.0 * result.energy_error) +
                           " % of what was stored" + (options.to_failure() ? "" : "; more --points bring them nearer"));
    }
}

}  // namespace kiln::bending
