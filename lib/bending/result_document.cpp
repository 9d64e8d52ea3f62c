// result_document.cpp: results of a bending test as JSON and as a state.
#include "bending/result_document.h"

#include "io/material_io.h"
#include "io/state_io.h"
#include "physics/bending.h"

namespace kiln::bending {

namespace {

NamedArray vectors(const std::string& name, const std::vector<Vec3>& rows) {
    std::vector<double> data;
    for (const Vec3& row : rows) data.insert(data.end(), row.begin(), row.end());
    return {name, {{rows.size(), 3}, std::move(data)}};
}

/// Replaces an array of the same name, which a state that was bent before may have.
void put(std::vector<NamedArray>& arrays, NamedArray array) {
    std::erase_if(arrays, [&](const NamedArray& other) { return other.name == array.name; });
    arrays.push_back(std::move(array));
}

void add_motion(Json& json, const DynamicRun& run, const Options& options) {
    json["energy"].update(Json{{"work", run.energy.work},
                               {"stored_at_end", run.energy.bonds + run.energy.contacts},
                               {"kinetic_at_end", run.energy.kinetic},
                               {"damping", run.energy.damping}});
    json["time_step"] = run.time_step;
    json["steps"] = run.steps;
    json["punch_velocity"] = run.velocity;
    json["damping"] = options.damping;
    json["mass_scaling"] = options.mass_scaling;
}

void add_failure(Json& json, const Result& result, const Options& options) {
    const Vec3& size = result.specimen.size;
    const auto strength = [&](double force) { return physics::bending_strength(force, result.fixture.span, size[1], size[2]); };
    const auto& found = result.calibration;
    const double tensile = found ? found->tensile_strength : options.tensile_strength;
    json["strength"] = {{"bending_strength", strength(result.peak_force)},
                        {"peak_force", result.peak_force},
                        {"first_break", strength(result.curve[1].force)},
                        {"breaks", result.breaks},
                        {"tensile_strength", tensile > 0.0 ? Json(tensile) : Json()},
                        {"shear_strength", options.shear_strength > 0.0 ? Json(options.shear_strength) : Json()},
                        {"calibrated_to", found ? Json(options.calibrate_to) : Json()},
                        {"tests", found ? found->tests : 1},
                        {"until", options.until}};
    json["energy"].update(Json{{"work", result.failure.work}, {"dissipated", result.failure.dissipated}});
}

}  // namespace

Json summary(const Result& result) {
    const mechanics::BondedBody& body = result.specimen.body;
    return {{"dropped_bonds", result.specimen.dropped_bonds},
            {"negligible_bonds", body.negligible_bonds},
            {"fragments", body.fragments},
            {"fragment_particles", body.fragment_particles},
            {"rattlers", body.rattlers},
            {"contacts", result.contacts},
            {"closed_gaps", result.closed_gaps},
            {"converged", result.converged}};
}

Json document(const Result& result, const Options& options, const Json& history) {
    const Specimen& specimen = result.specimen;
    Json json{{"format", "dem-bend"},
              {"version", io::format_version},
              {"units", "SI"},
              {"material", io::material_names(specimen.state)},
              {"relative_density", specimen.relative_density},
              {"span", result.fixture.span},
              {"effective_span", physics::equivalent_span(result.held_span, result.fixture.span)},
              {"width", specimen.size[1]},
              {"height", specimen.size[2]},
              {"length", specimen.size[0]},
              {"slenderness", result.fixture.span / specimen.size[2]},
              {"punch_radius", result.fixture.radius},
              {"bond_law", physics::name_of(*specimen.body.model.law)},
              {"bond_shear", specimen.body.model.shear ? Json(physics::name_of(*specimen.body.model.shear)) : Json()},
              {"method", name_of(options.method)},
              {"friction", options.friction},
              {"young_modulus", specimen.young_modulus},
              {"poisson_ratio", specimen.poisson_ratio},
              {"poisson_ratio_source", "material " + specimen.solid},
              {"particles", specimen.body.particle.size()},
              {"bonds", specimen.body.bond.size()}};
    Json deflection = Json::array(), punch = Json::array(), force = Json::array();
    for (const Point& point : result.curve) {
        deflection.push_back(point.deflection);
        punch.push_back(point.punch);
        force.push_back(point.force);
    }
    json["curve"] = {{"deflection", deflection}, {"punch", punch}, {"force", force}};
    json["roll"] = specimen.turn.norm();
    json["horizontal_reaction"] = result.thrust;
    json["energy"] = {{"bonds", result.peak.bond_energy},
                      {"contacts", result.peak.contact_energy},
                      {"friction", result.friction_loss},
                      {"error", result.energy_error}};
    if (options.to_failure()) add_failure(json, result, options);
    if (options.method == Method::motion) {
        add_motion(json, result.dynamic, options);
    } else {
        json["iterations"] = result.iterations;
        json["residual"] = result.residual;
    }
    json.update(summary(result));
    json["warnings"] = result.warnings;
    json["history"] = history;
    return json;
}

State bent_state(const Result& result) {
    const mechanics::BondedBody& body = result.specimen.body;
    const mechanics::BondNetwork& network = body.network;
    State state = result.specimen.state;
    state.particles = take_rows(state.particles, body.particle);
    state.bonds = take_rows(*state.bonds, body.bond);
    state.bonds->pair = network.pair;
    std::vector<Vec3> displacement, rotation, force, moment;
    for (std::size_t node = 0; node < network.nodes(); ++node) {
        const mechanics::Vec6& freedoms = result.peak.displacement[node];
        state.particles.position[node] += freedoms.head<3>();
        displacement.emplace_back(result.specimen.moved[node] + freedoms.head<3>());
        rotation.emplace_back(result.specimen.turn + freedoms.tail<3>() / network.rotation_length);
    }
    std::vector<double> tension, tensile, shear;
    const std::vector<mechanics::BondLoad>& loads = result.loads;
    for (std::size_t bond = 0; bond < loads.size(); ++bond) {
        force.push_back(loads[bond].force);
        moment.push_back(loads[bond].moment);
        tension.push_back(loads[bond].tension);
        const physics::BondStress stress = mechanics::stress_of(network, bond, loads[bond]);
        tensile.push_back(stress.tensile);
        shear.push_back(stress.shear);
    }
    put(state.particles.other, vectors("displacement", displacement));
    put(state.particles.other, vectors("rotation", rotation));
    put(state.bonds->other, vectors("force", force));
    put(state.bonds->other, {"normal_force", {{tension.size()}, std::move(tension)}});
    put(state.bonds->other, vectors("moment", moment));
    put(state.bonds->other, {"tensile_stress", {{tensile.size()}, std::move(tensile)}});
    put(state.bonds->other, {"shear_stress", {{shear.size()}, std::move(shear)}});
    if (!result.broken.empty()) put(state.bonds->other, {"broken", {{result.broken.size()}, result.broken}});
    return state;
}

}  // namespace kiln::bending
