// state_io.cpp: the rules of dem-state: which keys and arrays there are, their defaults, and what is refused.
#include "io/state_io.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <numeric>
#include <unordered_set>

#include "io/array_types.h"
#include "physics/materials.h"

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

/// Checks type and shape of a known array and gives its values, `width` in a row. rows: how many there must be.
template <typename Value>
std::vector<Value> values_of(Array&& array, const std::string& where, std::size_t rows, std::size_t width) {
    auto* values = std::get_if<std::vector<Value>>(&array.data);
    if (!values) {
        Array wanted;
        wanted.data = std::vector<Value>();
        throw Error(where + " has type " + type_name(array) + ", wanted " + type_name(wanted));
    }
    const std::vector<std::size_t> shape = width == 1 ? std::vector<std::size_t>{rows} : std::vector<std::size_t>{rows, width};
    if (array.shape != shape) throw Error(where + " has shape " + Json(array.shape).dump() + ", wanted " + Json(shape).dump());
    if constexpr (std::is_floating_point_v<Value>)
        for (std::size_t index = 0; index < values->size(); ++index)
            if (!std::isfinite((*values)[index])) throw Error(where + ", row " + std::to_string(index / width) + ": is not a finite number");
    return std::move(*values);
}

/// Values of a column whose row is a fixed-size type such as Vec3 or Image.
template <typename Row, typename Value>
std::vector<Row> rows_of(Array&& array, const std::string& where, std::size_t rows) {
    constexpr std::size_t width = sizeof(Row) / sizeof(Value);
    const std::vector<Value> values = values_of<Value>(std::move(array), where, rows, width);
    std::vector<Row> result(rows);
    if (rows > 0) std::memcpy(static_cast<void*>(result.data()), values.data(), values.size() * sizeof(Value));
    return result;
}

template <typename Row, typename Value>
Array array_of_rows(const std::vector<Row>& rows) {
    constexpr std::size_t width = sizeof(Row) / sizeof(Value);
    std::vector<Value> values(rows.size() * width);
    if (!rows.empty()) std::memcpy(values.data(), static_cast<const void*>(rows.data()), values.size() * sizeof(Value));
    return {{rows.size(), width}, std::move(values)};
}

template <typename Value>
Array array_of(std::vector<Value>&& values) {
    return {{values.size()}, std::move(values)};
}

Vec3 vector_from(const Json& json, const std::string& where) {
    if (!json.is_array() || json.size() != 3) throw Error(where + " is " + json.dump() + ", not a list of three numbers");
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
    if (!json["vectors"].is_array() || json["vectors"].size() != 3) throw Error(place + ": box.vectors is not a list of three vectors");
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto row = static_cast<Eigen::Index>(axis);
        Vec3 vector = vector_from(json["vectors"][axis], place + ": box.vectors");
        box.lengths[row] = vector[row];
        vector[row] = 0.0;
        if (!(box.lengths[row] > 0.0) || vector.norm() > off_axis * box.lengths[row])
            throw Error(place + ": box vector " + std::to_string(axis) + " is " + json["vectors"][axis].dump() +
                        "; only boxes with positive edges along x, y, z are supported");
    }
    if (json.contains("periodic")) {
        const Json& periodic = json["periodic"];
        if (!periodic.is_array() || periodic.size() != 3) throw Error(place + ": box.periodic is not a list of three true or false");
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (!periodic[axis].is_boolean()) throw Error(place + ": box.periodic is not a list of three true or false");
            box.periodic[axis] = periodic[axis].get<bool>();
        }
    }
    return box;
}

void check_kind(const Json& header, const std::string& place) {
    if (const Json format = header.value("format", Json("dem-state")); format != "dem-state")
        throw Error(place + ": is " + format.dump() + ", wanted dem-state");
    if (const Json version = header.value("version", Json(format_version)); version != format_version)
        throw Error(place + ": has version " + version.dump() + ", this program knows version " + std::to_string(format_version));
    if (const Json units = header.value("units", Json("SI")); units != "SI")
        throw Error(place + ": has units " + units.dump() + ", wanted \"SI\"");
}

void check_ids(const std::vector<std::int64_t>& ids, const std::string& where) {
    if (std::adjacent_find(ids.begin(), ids.end(), std::greater_equal<>()) == ids.end()) return;
    std::unordered_set<std::int64_t> seen;
    for (std::size_t row = 0; row < ids.size(); ++row)
        if (!seen.insert(ids[row]).second) throw Error(where + ", row " + std::to_string(row) + ": id " + std::to_string(ids[row]) + " is repeated");
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
            throw Error(place + ": particle " + std::to_string(particles.id[row]) + " (row " + std::to_string(row) + ") has " + cause);
        };
        if (!(particles.radius[row] > 0.0)) refuse("radius " + Json(particles.radius[row]).dump() + ", wanted a positive one");
        if (particles.material[row] < 0 || static_cast<std::size_t>(particles.material[row]) >= materials)
            refuse("material " + std::to_string(particles.material[row]) + ", there are " + std::to_string(materials));
    }
    for (const NamedArray& named : arrays)
        if (named.array.rows() != count)
            throw Error(where + named.name + " has " + std::to_string(named.array.rows()) + " rows, there are " + std::to_string(count) +
                        " particles");
    particles.other = std::move(arrays);
    return particles;
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
        const auto refuse = [&](const std::string& cause) { throw Error(place + ": bond " + std::to_string(row) + " has " + cause); };
        for (const std::int32_t particle : bonds.pair[row])
            if (particle < 0 || static_cast<std::size_t>(particle) >= particles)
                refuse("particle row " + std::to_string(particle) + ", there are " + std::to_string(particles));
        if (bonds.radius[row] < 0.0) refuse("radius " + Json(bonds.radius[row]).dump());
        if (default_volume)
            bonds.volume.push_back(std::numbers::pi * bonds.radius[row] * bonds.radius[row] * std::max(0.0, bonds.length[row]));
    }
    for (const NamedArray& named : arrays)
        if (named.array.rows() != count)
            throw Error(where + named.name + " has " + std::to_string(named.array.rows()) + " rows, there are " + std::to_string(count) +
                        " bonds");
    bonds.other = std::move(arrays);
    return bonds;
}

const Json& list_at(const Json& header, const char* key, const std::string& place) {
    static const Json empty = Json::array();
    if (!header.contains(key)) return empty;
    if (!header[key].is_array()) throw Error(place + ": " + key + " is not a list");
    return header[key];
}

}  // namespace

State state_from(Document document) {
    const Json& header = document.header;
    const std::string& place = document.place;
    check_kind(header, place);
    State state;
    if (header.contains("time")) state.time = number_from(header["time"], place + ": time", std::numeric_limits<double>::lowest());
    if (header.contains("temperature")) state.temperature = number_from(header["temperature"], place + ": temperature", 0.0);
    state.box = box_from(header, place);
    for (const Json& json : list_at(header, "materials", place)) state.materials.push_back(material_from(json, place));
    if (state.materials.empty()) state.materials.push_back(physics::builtin_material("alumina"));
    for (const Json& json : list_at(header, "contacts", place))
        state.contacts.push_back(material_pair_from(json, state.materials, place));
    state.history = list_at(header, "history", place);
    state.particles = particles_from(std::move(document.particles), state.materials.size(), place);
    if (document.has_bonds) state.bonds = bonds_from(std::move(document.bonds), state.particles.size(), place);
    state.other = std::move(document.header);
    for (const char* key : {"format", "version", "units", "time", "temperature", "box", "materials", "contacts", "history"})
        state.other.erase(key);
    return state;
}

Document document_from(State state) {
    Document document;
    const Vec3& origin = state.box.origin;
    const Vec3& lengths = state.box.lengths;
    Json& header = document.header;
    header = {{"format", "dem-state"}, {"version", format_version}, {"units", "SI"}, {"time", state.time}};
    if (state.temperature) header["temperature"] = *state.temperature;
    header["box"] = {{"origin", {origin[0], origin[1], origin[2]}},
                     {"vectors", {{lengths[0], 0.0, 0.0}, {0.0, lengths[1], 0.0}, {0.0, 0.0, lengths[2]}}},
                     {"periodic", state.box.periodic}};
    header["materials"] = Json::array();
    for (const Material& material : state.materials) header["materials"].push_back(material_json(material));
    for (const MaterialPair& pair : state.contacts) header["contacts"].push_back(material_pair_json(pair, state.materials));
    for (const auto& [key, value] : state.other.items()) header[key] = value;
    header["history"] = std::move(state.history);

    Particles& particles = state.particles;
    const Array positions = array_of_rows<Vec3, double>(particles.position);
    document.particles = {{"id", array_of(std::move(particles.id))},
                          {"position", positions},
                          {"radius", array_of(std::move(particles.radius))},
                          {"material", array_of(std::move(particles.material))}};
    std::move(particles.other.begin(), particles.other.end(), std::back_inserter(document.particles));
    if (state.bonds) {
        Bonds& bonds = *state.bonds;
        document.has_bonds = true;
        document.bonds = {{"pair", array_of_rows<std::array<std::int32_t, 2>, std::int32_t>(bonds.pair)},
                          {"image", array_of_rows<Image, std::int8_t>(bonds.image)},
                          {"radius", array_of(std::move(bonds.radius))},
                          {"length", array_of(std::move(bonds.length))},
                          {"volume", array_of(std::move(bonds.volume))}};
        std::move(bonds.other.begin(), bonds.other.end(), std::back_inserter(document.bonds));
    }
    return document;
}

}  // namespace kiln::io
