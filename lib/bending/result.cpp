// result.cpp: where all methods begin, and what the contacts of an equilibrium say.
#include "bending/result.h"

#include <algorithm>

namespace kiln::bending {

Result prepare(State state, const Options& options) {
    Result result;
    result.specimen = cut_specimen(std::move(state), options.model);
    result.fixture = place_fixture(result.specimen, options);
    result.curve.push_back({0.0, 0.0, 0.0});
    return result;
}

void read_contacts(Result& result, const mechanics::Tooling& tooling, const mechanics::Equilibrium& equilibrium) {
    const std::vector<Vec3>& forces = equilibrium.contact_force;
    result.contacts =
        static_cast<std::size_t>(std::ranges::count_if(forces, [](const Vec3& force) { return force != Vec3::Zero(); }));
    result.closed_gaps = equilibrium.closed_gaps;
    result.held_span = held_span(result.specimen, tooling, forces);
    result.thrust = thrust(tooling, forces);
}

}  // namespace kiln::bending
