// material_io.cpp: keys of materials and their ranges.
#include "io/material_io.h"

#include <fstream>

#include "io/json_values.h"
#include "physics/materials.h"

namespace kiln::io {

namespace {

/// Where a key of the format lives in the struct.
struct Field {
    const char* key;
    std::optional<double> Material::*member;
    double lowest;  // smallest value allowed
};

constexpr Field fields[] = {
    {"density", &Material::density, 0.0},
    {"surface_energy", &Material::surface_energy, 0.0},
    {"atomic_volume", &Material::atomic_volume, 0.0},
    {"diffusion_parameter", &Material::diffusion_parameter, 0.0},
    {"dihedral_angle", &Material::dihedral_angle, 0.0},
    {"young_modulus", &Material::young_modulus, 0.0},
    {"poisson_ratio", &Material::poisson_ratio, -1.0},
};

constexpr const char* assumed_key = "assumed";

/// The same for an object with prefactor and activation_energy.
struct Activated {
    const char* key;
    std::optional<double> Material::*prefactor;
    std::optional<double> Material::*energy;
};

constexpr Activated activated[] = {
    {"grain_boundary_diffusion", &Material::diffusion_prefactor, &Material::activation_energy},
    {"surface_diffusion", &Material::surface_prefactor, &Material::surface_activation},
    {"boundary_mobility", &Material::mobility_prefactor, &Material::mobility_activation},
};

/// The two numbers of an object; throws Error that says which is missing and what there is instead.
void check_activated(const Json& object, const std::string& where) {
    std::string missing, there;
    for (const char* key : {"prefactor", "activation_energy"})
        if (!object.is_object() || !object.contains(key)) missing += (missing.empty() ? "" : " and ") + std::string(key);
    if (missing.empty()) return;
    if (object.is_object())
        for (const auto& [key, value] : object.items()) there += (there.empty() ? "; it has " : ", ") + clipped(key);
    throw Error(where + " needs " + missing + there);
}

}  // namespace

std::vector<std::string> material_keys() {
    std::vector<std::string> keys;
    for (const Field& field : fields) keys.emplace_back(field.key);
    for (const Activated& field : activated) keys.emplace_back(field.key);
    return keys;
}

Material material_from(const Json& json, const std::string& place) {
    if (!json.is_object() || !json.contains("name") || !json["name"].is_string())
        throw Error(place + ": a material is an object with a name");
    Material material;
    material.name = json["name"].get<std::string>();
    const std::string where = place + ": material '" + clipped(material.name) + "': ";
    Json other = json;
    other.erase("name");
    for (const Field& field : fields) {
        if (!json.contains(field.key)) continue;
        material.*field.member = number_from(json[field.key], where + field.key, field.lowest);
        other.erase(field.key);
    }
    for (const Activated& field : activated) {
        if (!json.contains(field.key)) continue;
        const Json& object = json[field.key];
        check_activated(object, where + field.key);
        material.*field.prefactor = number_from(object["prefactor"], where + "prefactor", 0.0);
        material.*field.energy = number_from(object["activation_energy"], where + "activation_energy", 0.0);
        Json& carried = other[field.key];
        carried.erase("prefactor");
        carried.erase("activation_energy");
        if (carried.empty()) other.erase(field.key);
    }
    material.other = text_of(other);
    return material;
}

Material assumed_material() {
    Material material = physics::builtin_material("alumina");
    material.other = text_of(Json{{assumed_key, true}});
    return material;
}

bool is_assumed(const Material& material) {
    return carried_json(material.other, "the unknown keys of material '" + material.name + "'").value(assumed_key, Json()) == true;
}

bool names_no_material(const State& state) {
    return state.materials.size() == 1 && state.contacts.empty() && is_assumed(state.materials.front());
}

Json material_names(const State& state) {
    std::vector<char> used(state.materials.size(), state.materials.size() == 1);
    for (const std::int32_t row : state.particles.material) used[static_cast<std::size_t>(row)] = 1;
    std::string names;
    for (std::size_t row = 0; row < used.size(); ++row) {
        if (!used[row]) continue;
        if (is_assumed(state.materials[row])) return nullptr;
        names += (names.empty() ? "" : ", ") + state.materials[row].name;
    }
    return names;
}

Material material_named(const std::string& name) {
    if (!name.ends_with(".json")) return physics::builtin_material(name);
    std::ifstream file(name);
    if (!file) throw Error(name + ": the material cannot be read");
    const Json json = Json::parse(file, nullptr, false);
    if (json.is_discarded()) throw Error(name + ": is not JSON");
    return material_from(json, name);
}

Json material_json(const Material& material) {
    Json json{{"name", material.name}};
    for (const Field& field : fields)
        if (material.*field.member) json[field.key] = *(material.*field.member);
    for (const Activated& field : activated)
        if (material.*field.prefactor && material.*field.energy)
            json[field.key] = {{"prefactor", *(material.*field.prefactor)}, {"activation_energy", *(material.*field.energy)}};
    put_back(json, carried_json(material.other, "the unknown keys of material '" + material.name + "'"));
    return json;
}

MaterialPair material_pair_from(const Json& json, const std::vector<Material>& materials, const std::string& place) {
    if (!json.is_object() || !json.contains("materials") || !json["materials"].is_array() || json["materials"].size() != 2)
        throw Error(place + ": a contact is an object with the names of two materials");
    MaterialPair pair;
    for (std::size_t side = 0; side < 2; ++side) {
        const Json& name = json["materials"][side];
        std::size_t row = 0;
        while (row < materials.size() && name != materials[row].name) ++row;
        if (row == materials.size()) throw Error(place + ": contacts name an unknown material " + shown(name));
        pair.materials[side] = static_cast<std::int32_t>(row);
    }
    const std::string where = place + ": contact of " + shown(json["materials"]) + ": ";
    const auto read = [&](const char* key, std::optional<double>& target) {
        if (json.contains(key)) target = number_from(json[key], where + key, 0.0);
    };
    read("surface_energy", pair.surface_energy);
    read("diffusion_parameter", pair.diffusion_parameter);
    return pair;
}

Json material_pair_json(const MaterialPair& pair, const std::vector<Material>& materials) {
    const auto name = [&](std::int32_t row) { return materials[static_cast<std::size_t>(row)].name; };
    Json json{{"materials", {name(pair.materials[0]), name(pair.materials[1])}}};
    if (pair.surface_energy) json["surface_energy"] = *pair.surface_energy;
    if (pair.diffusion_parameter) json["diffusion_parameter"] = *pair.diffusion_parameter;
    return json;
}

}  // namespace kiln::io
