// state_io.cpp: a state from a document by the rules of dem-state: keys and arrays, their defaults, and what is refused; and the
// way back.
#include "io/state_io.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <numbers>
#include <numeric>
#include <unordered_set>
#include <utility>

#include "io/column.h"
#include "io/json_values.h"
#include "io/material_io.h"

namespace kiln::io {

namespace {

constexpr double off_axis = 1e-12;  // part of a box vector's length that may stick out of its axis

/// Takes the array of that name out of the list; nothing if it is not there.
std::optional<Array> extract(std::vector<NamedArray>& arrays, const std::string& name) {
    const auto found = std::find_if(arrays.begin(), arrays.end(), [&](const NamedArray& each) { return each.name == name; });
    if (found == arrays.end()) return std::nullopt;
    Array array = std::move(found->array);
    arrays.erase(found);
    return array;
}

Vec3 vector_from(const Json& json, const std::string& where) {
    if (!json.is_array() || json.size() != 3) throw Error(where + " is " + shown(json) + ", not a list of three numbers");
    Vec3 vector;
    for (std::size_t axis = 0; axis < 3; ++axis)
        vector[static_cast<Eigen::Index>(axis)] = number_from(json[axis], where, std::numeric_limits<double>::lowest());
    return vector;
}

Box box_from(const Json& header, const std::string& place) {
    if (!header.contains("box") || !header["box"].is_object() || !header["box"].contains("vectors"))
        throw Error(place + ": has no box with vectors");
    const Json& json = header["box"];
    Box box;
    if (json.contains("origin")) box.origin = vector_from(json["origin"], place + ": box.origin");
    if (!json["vectors"].is_array() || json["vectors"].size() != 3)
        throw Error(place + ": box.vectors is not a list of three vectors");
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto row = static_cast<Eigen::Index>(axis);
        Vec3 vector = vector_from(json["vectors"][axis], place + ": box.vectors");
        box.lengths[row] = vector[row];
        vector[row] = 0.0;
        if (!(box.lengths[row] > 0.0) || vector.norm() > off_axis * box.lengths[row])
            throw Error(place + ": box vector " + std::to_string(axis) + " is " + shown(json["vectors"][axis]) +
                        "; only boxes with positive edges along x, y, z are supported");
    }
    if (json.contains("periodic")) {
        const Json& periodic = json["periodic"];
        const bool three = periodic.is_array() && periodic.size() == 3;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (!three || !periodic[axis].is_boolean()) throw Error(place + ": box.periodic is not a list of three true or false");
            box.periodic[axis] = periodic[axis].get<bool>();
        }
    }
    return box;
}

void check_kind(const Json& header, const std::string& place) {
    if (const Json format = header.value("format", Json("dem-state")); format != "dem-state")
        throw Error(place + ": is " + shown(format) + ", expected dem-state");
    if (const Json version = header.value("version", Json(format_version)); version != format_version)
        throw Error(place + ": has version " + shown(version) + ", this program knows version " + std::to_string(format_version));
    if (const Json units = header.value("units", Json("SI")); units != "SI")
        throw Error(place + ": has units " + shown(units) + ", expected \"SI\"");
}

void check_ids(const std::vector<std::int64_t>& ids, const std::string& where) {
    if (std::adjacent_find(ids.begin(), ids.end(), std::greater_equal<>()) == ids.end()) return;
    std::unordered_set<std::int64_t> seen;
    for (std::size_t row = 0; row < ids.size(); ++row)
        if (!seen.insert(ids[row]).second)
            throw Error(where + ", row " + std::to_string(row) + ": id " + std::to_string(ids[row]) + " is repeated");
}

/// Arrays that nobody here knows have a row for each particle or bond too.
void check_rows(const std::vector<NamedArray>& arrays, const std::string& where, std::size_t rows, const char* what) {
    for (const NamedArray& named : arrays)
        if (named.array.rows() != rows)
            throw Error(where + clipped(named.name) + " has " + std::to_string(named.array.rows()) + " rows, there are " +
                        std::to_string(rows) + " " + what);
}

Particles particles_from(std::vector<NamedArray> arrays, std::size_t materials, const std::string& place) {
    Particles particles;
    const std::string where = place + ": particles.";
    std::optional<Array> position = extract(arrays, "position"), radius = extract(arrays, "radius");
    if (!position || !radius) throw Error(place + ": has no particles." + (position ? "radius" : "position"));
    const std::size_t count = radius->rows();
    particles.radius = values_of<double>(std::move(*radius), where + "radius", count, 1);
    particles.position = rows_of<Vec3, double>(std::move(*position), where + "position", count);

    if (auto id = extract(arrays, "id")) {
        particles.id = values_of<std::int64_t>(std::move(*id), where + "id", count, 1);
        check_ids(particles.id, where + "id");
    } else {
        particles.id.resize(count);
        std::iota(particles.id.begin(), particles.id.end(), 0);
    }
    if (auto material = extract(arrays, "material"))
        particles.material = values_of<std::int32_t>(std::move(*material), where + "material", count, 1);
    else
        particles.material.assign(count, 0);

    for (std::size_t row = 0; row < count; ++row) {
        const auto refuse = [&](const std::string& cause) {
            throw Error(place + ": particle " + std::to_string(particles.id[row]) + " (row " + std::to_string(row) + ") has " +
                        cause);
        };
        if (!(particles.radius[row] > 0.0)) refuse("radius " + shown(particles.radius[row]) + ", expected a positive one");
        if (particles.material[row] < 0 || static_cast<std::size_t>(particles.material[row]) >= materials)
            refuse("material " + std::to_string(particles.material[row]) + ", there are " + std::to_string(materials));
    }
    check_rows(arrays, where, count, "particles");
    particles.other = std::move(arrays);
    return particles;
}

/// The two ends of a bond or neck in the order that does not depend on how it is written: i to j across a face is j to i across the
/// other.
template <typename Joints>
std::array<int, 5> ends_of(const Joints& bonds, std::size_t row) {
    const auto [i, j] = bonds.pair[row];
    const Image& image = bonds.image[row];
    const std::array<int, 5> forward{i, j, image[0], image[1], image[2]}, backward{j, i, -image[0], -image[1], -image[2]};
    return std::min(forward, backward);
}

/// A bond or neck that stands twice would carry twice.
template <typename Joints>
void check_twice(const Joints& bonds, const char* what, const std::string& place) {
    std::vector<std::pair<std::array<int, 5>, std::size_t>> ends(bonds.size());
    for (std::size_t row = 0; row < ends.size(); ++row) ends[row] = {ends_of(bonds, row), row};
    if (!std::ranges::is_sorted(ends)) std::ranges::sort(ends);
    const auto found = std::ranges::adjacent_find(ends, {}, [](const auto& each) { return each.first; });
    if (found == ends.end()) return;
    const std::size_t first = found->second, again = std::next(found)->second;
    throw Error(place + ": " + what + " " + std::to_string(first) + " and " + std::to_string(again) +
                " are one: both join particle rows " + std::to_string(bonds.pair[first][0]) + " and " +
                std::to_string(bonds.pair[first][1]) + " with the same image");
}

/// Calls refuse(cause) for ends that are no rows, or the same particle twice.
template <typename Refuse>
void check_ends(const std::array<std::int32_t, 2>& pair, const Image& image, std::size_t particles, const Refuse& refuse) {
    for (const std::int32_t particle : pair)
        if (particle < 0 || static_cast<std::size_t>(particle) >= particles)
            refuse("particle row " + std::to_string(particle) + ", there are " + std::to_string(particles));
    if (pair[0] == pair[1] && image == Image{0, 0, 0}) refuse("particle row " + std::to_string(pair[0]) + " at both ends");
}

Bonds bonds_from(std::vector<NamedArray> arrays, std::size_t particles, const std::string& place) {
    Bonds bonds;
    const std::string where = place + ": bonds.";
    std::optional<Array> pair = extract(arrays, "pair"), radius = extract(arrays, "radius"), length = extract(arrays, "length");
    if (!pair || !radius || !length) throw Error(place + ": bonds need the arrays pair, radius and length");
    const std::size_t count = pair->rows();
    bonds.pair = rows_of<std::array<std::int32_t, 2>, std::int32_t>(std::move(*pair), where + "pair", count);
    bonds.radius = values_of<double>(std::move(*radius), where + "radius", count, 1);
    bonds.length = values_of<double>(std::move(*length), where + "length", count, 1);
    if (auto image = extract(arrays, "image"))
        bonds.image = rows_of<Image, std::int8_t>(std::move(*image), where + "image", count);
    else
        bonds.image.assign(count, Image{0, 0, 0});
    if (auto volume = extract(arrays, "volume")) bonds.volume = values_of<double>(std::move(*volume), where + "volume", count, 1);

    const bool default_volume = bonds.volume.empty();
    for (std::size_t row = 0; row < count; ++row) {
        const auto refuse = [&](const std::string& cause) {
            throw Error(place + ": bond " + std::to_string(row) + " has " + cause);
        };
        check_ends(bonds.pair[row], bonds.image[row], particles, refuse);
        if (bonds.radius[row] < 0.0) refuse("radius " + shown(bonds.radius[row]) + ", expected none below zero");
        if (default_volume)
            bonds.volume.push_back(std::numbers::pi * bonds.radius[row] * bonds.radius[row] * std::max(0.0, bonds.length[row]));
    }
    check_twice(bonds, "bonds", place);
    check_rows(arrays, where, count, "bonds");
    bonds.other = std::move(arrays);
    return bonds;
}

Necks necks_from(std::vector<NamedArray> arrays, std::size_t particles, const std::string& place) {
    Necks necks;
    const std::string where = place + ": necks.";
    std::optional<Array> pair = extract(arrays, "pair"), radius = extract(arrays, "radius"), image = extract(arrays, "image");
    if (!pair || !radius) throw Error(place + ": necks need the arrays pair and radius");
    const std::size_t count = pair->rows();
    necks.pair = rows_of<std::array<std::int32_t, 2>, std::int32_t>(std::move(*pair), where + "pair", count);
    necks.radius = values_of<double>(std::move(*radius), where + "radius", count, 1);
    if (image)
        necks.image = rows_of<Image, std::int8_t>(std::move(*image), where + "image", count);
    else
        necks.image.assign(count, Image{0, 0, 0});
    for (std::size_t row = 0; row < count; ++row) {
        const auto refuse = [&](const std::string& cause) {
            throw Error(place + ": neck " + std::to_string(row) + " has " + cause);
        };
        check_ends(necks.pair[row], necks.image[row], particles, refuse);
        if (necks.radius[row] < 0.0) refuse("radius " + shown(necks.radius[row]) + ", expected none below zero");
    }
    check_twice(necks, "necks", place);
    check_rows(arrays, where, count, "necks");
    necks.other = std::move(arrays);
    return necks;
}

const Json& list_at(const Json& header, const char* key, const std::string& place) {
    static const Json empty = Json::array();
    if (!header.contains(key)) return empty;
    if (!header[key].is_array()) throw Error(place + ": " + key + " is not a list");
    return header[key];
}

std::vector<Material> materials_from(const Json& header, const std::string& place) {
    std::vector<Material> materials;
    for (const Json& json : list_at(header, "materials", place)) {
        Material material = material_from(json, place);
        const auto same_name = [&](const Material& other) { return other.name == material.name; };
        if (std::any_of(materials.begin(), materials.end(), same_name))
            throw Error(place + ": material '" + clipped(material.name) + "' stands twice");
        materials.push_back(std::move(material));
    }
    if (materials.empty()) materials.push_back(assumed_material());
    return materials;
}

/// The header without all that a State holds in its own members.
Json unknown_keys(Json header) {
    const auto erase = [](Json& object, std::initializer_list<const char*> keys) {
        for (const char* key : keys) object.erase(key);
        return object.empty();
    };
    erase(header, {"format", "version", "units", "time", "temperature", "materials", "history"});
    if (erase(header["box"], {"origin", "vectors", "periodic"})) header.erase("box");
    if (header.contains("contacts")) {
        bool all_known = true;
        for (Json& contact : header["contacts"])
            all_known &= erase(contact, {"materials", "surface_energy", "diffusion_parameter"});
        if (all_known) header.erase("contacts");
    }
    return header;
}

State checked_state(Document document) {
    const Json& header = document.header;
    const std::string& place = document.place;
    check_kind(header, place);
    State state;
    if (header.contains("time")) state.time = number_from(header["time"], place + ": time", std::numeric_limits<double>::lowest());
    if (header.contains("temperature")) state.temperature = number_from(header["temperature"], place + ": temperature", 0.0);
    state.box = box_from(header, place);
    state.materials = materials_from(header, place);
    for (const Json& json : list_at(header, "contacts", place))
        state.contacts.push_back(material_pair_from(json, state.materials, place));
    state.history = text_of(list_at(header, "history", place));
    for (const char* group : {"particles", "bonds", "necks"})
        if (header.contains(group)) throw Error(place + ": " + group + " is not an object of arrays");
    state.particles = particles_from(std::move(document.particles), state.materials.size(), place);
    if (document.has_bonds) state.bonds = bonds_from(std::move(document.bonds), state.particles.size(), place);
    if (document.has_necks) state.necks = necks_from(std::move(document.necks), state.particles.size(), place);
    state.other = text_of(unknown_keys(std::move(document.header)));
    return state;
}

}  // namespace

State state_from(Document document) {
    try {
        return checked_state(std::move(document));
    } catch (const Error& error) {
        throw PlacedError(error.what());
    }
}

namespace {

constexpr const char* written = "the state to be written: ";  // for a NaN that a calculation left behind

Json header_from(const State& state) {
    const Vec3& origin = state.box.origin;
    const Vec3& lengths = state.box.lengths;
    Json header{{"format", "dem-state"}, {"version", format_version}, {"units", "SI"}, {"time", state.time}};
    if (state.temperature) header["temperature"] = *state.temperature;
    header["box"] = {{"origin", {origin[0], origin[1], origin[2]}},
                     {"vectors", {{lengths[0], 0.0, 0.0}, {0.0, lengths[1], 0.0}, {0.0, 0.0, lengths[2]}}},
                     {"periodic", state.box.periodic}};
    header["materials"] = Json::array();  // stays empty where the state names none
    if (!names_no_material(state))
        for (const Material& material : state.materials) header["materials"].push_back(material_json(material));
    for (const MaterialPair& pair : state.contacts) header["contacts"].push_back(material_pair_json(pair, state.materials));
    put_back(header, carried_json(state.other, "the unknown keys of the state"));
    header["history"] = history_of(state);
    return header;
}

void move_to_end(std::vector<NamedArray>& target, std::vector<NamedArray>& source) {
    std::move(source.begin(), source.end(), std::back_inserter(target));
}

void add_bonds(Document& document, Bonds& bonds) {
    const std::string where = std::string(written) + "bonds.";
    document.has_bonds = true;
    document.bonds.push_back(column_of_rows<std::int32_t>("pair", bonds.pair, where));
    document.bonds.push_back(column_of_rows<std::int8_t>("image", bonds.image, where));
    document.bonds.push_back(column("radius", std::move(bonds.radius), where));
    document.bonds.push_back(column("length", std::move(bonds.length), where));
    document.bonds.push_back(column("volume", std::move(bonds.volume), where));
    move_to_end(document.bonds, bonds.other);
}

void add_necks(Document& document, Necks& necks) {
    const std::string where = std::string(written) + "necks.";
    document.has_necks = true;
    document.necks.push_back(column_of_rows<std::int32_t>("pair", necks.pair, where));
    document.necks.push_back(column_of_rows<std::int8_t>("image", necks.image, where));
    document.necks.push_back(column("radius", std::move(necks.radius), where));
    move_to_end(document.necks, necks.other);
}

}  // namespace

Json history_of(const State& state) {
    Json history = carried_json(state.history, "the history of the state");
    if (!history.is_array()) throw Error("the history of the state is no list");
    return history;
}

void append_history(State& state, const Json& entry) {
    check_finite(entry, std::string(written) + "history");
    Json history = history_of(state);
    history.push_back(entry);
    state.history = text_of(history);
}

Document document_from(State state) {
    Document document;
    document.header = header_from(state);

    Particles& particles = state.particles;
    const std::string of_particles = std::string(written) + "particles.";
    document.particles.push_back(column("id", std::move(particles.id), of_particles));
    document.particles.push_back(column_of_rows<double>("position", particles.position, of_particles));
    document.particles.push_back(column("radius", std::move(particles.radius), of_particles));
    document.particles.push_back(column("material", std::move(particles.material), of_particles));
    move_to_end(document.particles, particles.other);
    if (state.bonds) add_bonds(document, *state.bonds);
    if (state.necks) add_necks(document, *state.necks);
    return document;
}

}  // namespace kiln::io
