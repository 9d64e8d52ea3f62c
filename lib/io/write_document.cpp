// write_document.cpp: writing one document, as text or with 64-byte aligned binary arrays.
#include "io/write_document.h"

#include <cmath>

#include "io/array_types.h"
#include "io/files.h"
#include "io/json_values.h"

namespace kiln::io {

namespace {

constexpr std::size_t alignment = 64;  // bytes

std::size_t aligned(std::size_t bytes) { return (bytes + alignment - 1) / alignment * alignment; }

void put(std::FILE* file, const std::string& name, const void* data, std::size_t bytes) {
    if (bytes > 0 && std::fwrite(data, 1, bytes, file) != bytes) throw_system_error(name + ": cannot be written");
}

/// Keys of a header that the reader would take for arrays or for their size.
void check_reserved(const Json& header, const std::string& name) {
    bool taken = header.contains("bytes");
    for (const char* group : {"particles", "bonds", "necks"})
        taken = taken || (header.contains(group) && header[group].is_object());
    if (taken) throw Error(name + ": the keys particles, bonds, necks and bytes of a document belong to its arrays");
}

Json array_head(const Array& array) { return {{"type", type_name(array)}, {"shape", array.shape}}; }

Json text_array(const Array& array, const std::string& where) {
    Json spec = array_head(array);
    spec["data"] = std::visit(
        [&](const auto& values) {
            using Value = typename std::decay_t<decltype(values)>::value_type;
            Json data = Json::array();
            for (std::size_t index = 0; index < values.size(); ++index) {
                if constexpr (std::is_floating_point_v<Value>)
                    if (!std::isfinite(values[index]))
                        throw Error(where + ": value " + std::to_string(index) + " is not finite and text cannot hold it");
                data.push_back(values[index]);
            }
            return data;
        },
        array.data);
    return spec;
}

struct Payload {
    const void* data;
    std::size_t bytes;
};

Payload payload_of(const Array& array) {
    return std::visit([](const auto& values) { return Payload{values.data(), values.size() * sizeof(values[0])}; }, array.data);
}

/// What would make a stream that nobody can read.
void check_array(const Array& array, const Json& others, const std::string& name, const std::string& where) {
    if (others.contains(name)) throw Error(where + " stands twice");
    const std::size_t values = std::visit([](const auto& data) { return data.size(); }, array.data);
    if (array.shape.empty() || array.rows() * array.row_length() != values)
        throw Error(where + " has " + std::to_string(values) + " values where its shape requires " +
                    std::to_string(array.rows() * array.row_length()));
}

}  // namespace

void write_document(std::FILE* file, const std::string& name, const Document& document, bool text) {
    check_reserved(document.header, name);
    for (const auto& [key, value] : document.header.items()) check_finite(value, name + ": " + key);
    Json header = document.header;
    std::vector<Payload> payloads;
    std::size_t bytes = 0;
    const auto add_group = [&](const char* group, const std::vector<NamedArray>& arrays) {
        Json& specs = header[group] = Json::object();
        for (const NamedArray& named : arrays) {
            const std::string where = name + ": " + group + "." + named.name;
            check_array(named.array, specs, named.name, where);
            if (text) {
                specs[named.name] = text_array(named.array, where);
                continue;
            }
            specs[named.name] = array_head(named.array);
            specs[named.name]["at"] = bytes;
            payloads.push_back(payload_of(named.array));
            bytes += aligned(payloads.back().bytes);
        }
    };
    if (!document.particles.empty()) add_group("particles", document.particles);
    if (document.has_bonds) add_group("bonds", document.bonds);
    if (document.has_necks) add_group("necks", document.necks);
    if (!payloads.empty()) header["bytes"] = bytes;

    std::string line = text_of(header);
    if (!payloads.empty()) line.append(aligned(line.size() + 1) - line.size() - 1, ' ');
    line += '\n';
    put(file, name, line.data(), line.size());
    constexpr std::array<char, alignment> zeros{};
    for (const Payload& payload : payloads) {
        put(file, name, payload.data, payload.bytes);
        put(file, name, zeros.data(), aligned(payload.bytes) - payload.bytes);
    }
}

}  // namespace kiln::io
