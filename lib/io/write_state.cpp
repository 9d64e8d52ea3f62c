// write_state.cpp: a document from a state.
#include <iterator>

#include "io/column.h"
#include "io/json_line.h"
#include "io/state_io.h"

namespace kiln::io {

namespace {

constexpr const char* where = "the state to be written: ";  // for a NaN that a calculation left behind

Json header_from(const State& state) {
    const Vec3& origin = state.box.origin;
    const Vec3& lengths = state.box.lengths;
    Json header{{"format", "dem-state"}, {"version", format_version}, {"units", "SI"}, {"time", state.time}};
    if (state.temperature) header["temperature"] = *state.temperature;
    header["box"] = {{"origin", {origin[0], origin[1], origin[2]}},
                     {"vectors", {{lengths[0], 0.0, 0.0}, {0.0, lengths[1], 0.0}, {0.0, 0.0, lengths[2]}}},
                     {"periodic", state.box.periodic}};
    header["materials"] = Json::array();
    for (const Material& material : state.materials) header["materials"].push_back(material_json(material));
    for (const MaterialPair& pair : state.contacts) header["contacts"].push_back(material_pair_json(pair, state.materials));
    put_back(header, carried_json(state.other, "the unknown keys of the state"));
    header["history"] = history_of(state);
    return header;
}

void move_to_end(std::vector<NamedArray>& target, std::vector<NamedArray>& source) {
    std::move(source.begin(), source.end(), std::back_inserter(target));
}

}  // namespace

Json history_of(const State& state) {
    Json history = carried_json(state.history, "the history of the state");
    if (!history.is_array()) throw Error("the history of the state is no list");
    return history;
}

void append_history(State& state, const Json& entry) {
    check_finite(entry, std::string(where) + "history");
    Json history = history_of(state);
    history.push_back(entry);
    state.history = text_of(history);
}

Document document_from(State state) {
    Document document;
    document.header = header_from(state);

    Particles& particles = state.particles;
    const std::string of_particles = std::string(where) + "particles.";
    document.particles.push_back(column("id", std::move(particles.id), of_particles));
    document.particles.push_back(column_of_rows<double>("position", particles.position, of_particles));
    document.particles.push_back(column("radius", std::move(particles.radius), of_particles));
    document.particles.push_back(column("material", std::move(particles.material), of_particles));
    move_to_end(document.particles, particles.other);
    if (!state.bonds) return document;

    Bonds& bonds = *state.bonds;
    const std::string of_bonds = std::string(where) + "bonds.";
    document.has_bonds = true;
    document.bonds.push_back(column_of_rows<std::int32_t>("pair", bonds.pair, of_bonds));
    document.bonds.push_back(column_of_rows<std::int8_t>("image", bonds.image, of_bonds));
    document.bonds.push_back(column("radius", std::move(bonds.radius), of_bonds));
    document.bonds.push_back(column("length", std::move(bonds.length), of_bonds));
    document.bonds.push_back(column("volume", std::move(bonds.volume), of_bonds));
    move_to_end(document.bonds, bonds.other);
    return document;
}

}  // namespace kiln::io
