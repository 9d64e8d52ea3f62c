// document.cpp: reading one document of a stream; every size is checked before memory is taken.
#include "io/document.h"

#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <limits>
#include <set>

#include "io/array_types.h"

namespace kiln::io {

namespace {

constexpr std::size_t stream_buffer = 1 << 20;   // bytes
constexpr std::size_t first_chunk = 1 << 24;     // bytes of an array taken before its arrival is seen
constexpr std::size_t largest_row_count = std::size_t{1} << 31;

[[noreturn]] void fail(const std::string& place, const std::string& cause) { throw Error(place + ": " + cause); }

/// JSON of one line; a repeated key would hide a value, so it is an error.
Json parse_line(const std::string& line, const std::string& place) {
    std::vector<std::set<std::string>> keys;
    const auto watch = [&](int, nlohmann::detail::parse_event_t event, Json& value) {
        using Event = nlohmann::detail::parse_event_t;
        if (event == Event::object_start) keys.emplace_back();
        if (event == Event::object_end) keys.pop_back();
        if (event == Event::key && !keys.back().insert(value.get<std::string>()).second)
            fail(place, "key '" + value.get<std::string>() + "' stands twice");
        return true;
    };
    try {
        return Json::parse(line, watch);
    } catch (const Json::exception& error) {
        fail(place, "is not a line of JSON (byte " + std::to_string(dynamic_cast<const Json::parse_error*>(&error)
                                                                        ? dynamic_cast<const Json::parse_error&>(error).byte
                                                                        : 0) + ")");
    }
}

std::vector<std::size_t> shape_from(const Json& spec, const std::string& where) {
    if (!spec.contains("shape") || !spec["shape"].is_array() || spec["shape"].empty())
        fail(where, "has no shape, a list of sizes such as [N,3]");
    std::vector<std::size_t> shape;
    std::size_t values = 1;
    for (const Json& size : spec["shape"]) {
        if (!size.is_number_integer() || size.get<std::int64_t>() < 0 || size.get<std::uint64_t>() >= largest_row_count)
            fail(where, "shape " + spec["shape"].dump() + " is not a list of sizes");
        shape.push_back(size.get<std::size_t>());
        if (__builtin_mul_overflow(values, shape.back(), &values) || values > std::numeric_limits<std::int64_t>::max() / 8)
            fail(where, "shape " + spec["shape"].dump() + " is larger than any memory");
    }
    return shape;
}

std::size_t value_count(const std::vector<std::size_t>& shape) {
    std::size_t values = 1;
    for (const std::size_t size : shape) values *= size;
    return values;
}

template <typename Value>
Value value_from(const Json& item, const std::string& where, std::size_t index) {
    const auto refuse = [&](const std::string& wanted) -> void {
        fail(where, "value " + std::to_string(index) + " is " + item.dump() + " where " + wanted + " is needed");
    };
    if constexpr (std::is_floating_point_v<Value>) {
        if (!item.is_number()) refuse("a number");
        return item.get<Value>();
    } else {
        if (!item.is_number_integer()) refuse("a whole number");
        const bool too_large = item.is_number_unsigned() && item.get<std::uint64_t>() > std::numeric_limits<std::int64_t>::max();
        const std::int64_t value = item.get<std::int64_t>();
        if (too_large || value < std::int64_t{std::numeric_limits<Value>::min()} ||
            value > std::int64_t{std::numeric_limits<Value>::max()})
            refuse("a number that fits the array's type");
        return static_cast<Value>(value);
    }
}

/// An array whose values stand in the header as "data".
void read_text_data(Array& array, const Json& data, const std::string& where) {
    const std::size_t wanted = value_count(array.shape);
    if (!data.is_array() || data.size() != wanted)
        fail(where, "has " + std::to_string(data.is_array() ? data.size() : 0) + " values of data where its shape wants " +
                        std::to_string(wanted));
    std::visit(
        [&](auto& values) {
            using Value = typename std::decay_t<decltype(values)>::value_type;
            values.reserve(wanted);
            for (const Json& item : data) values.push_back(value_from<Value>(item, where, values.size()));
        },
        array.data);
}

/// Bytes from here to the end of a regular file; the largest number for pipes.
std::uint64_t bytes_left(std::FILE* file) {
    struct stat status {};
    const long here = std::ftell(file);
    if (here < 0 || fstat(fileno(file), &status) != 0 || !S_ISREG(status.st_mode)) return std::numeric_limits<std::uint64_t>::max();
    return static_cast<std::uint64_t>(std::max<off_t>(0, status.st_size - here));
}

/// An array in the payload: where it stands and where it goes.
struct Slot {
    std::uint64_t at;
    std::string where;
    Array* array;
};

/// Arrays of one group ("particles" or "bonds"): text data is read, payload arrays are noted in slots.
void read_group(const Json& group, const std::string& name, const std::string& place, std::vector<NamedArray>& arrays,
                std::vector<Slot>& slots) {
    if (!group.is_object()) fail(place, name + " is not an object of arrays");
    arrays.reserve(group.size());
    for (const auto& [key, spec] : group.items()) {
        const std::string where = place + ": " + name + "." + key;
        if (!spec.is_object() || !spec.contains("type") || !spec["type"].is_string())
            fail(where, "is not an array {\"type\":…,\"shape\":…,\"data\" or \"at\":…}");
        NamedArray& named = arrays.emplace_back(NamedArray{key, {shape_from(spec, where), {}}});
        if (!set_type(named.array, spec["type"].get<std::string>()))
            fail(where, "type '" + spec["type"].get<std::string>() + "' is unknown; there are " + known_types());
        if (spec.contains("data") == spec.contains("at")) fail(where, "needs either data or at");
        if (spec.contains("data")) {
            read_text_data(named.array, spec["data"], where);
        } else {
            if (!spec["at"].is_number_unsigned()) fail(where, "at is not an offset in bytes");
            slots.push_back({spec["at"].get<std::uint64_t>(), where, &named.array});
        }
    }
}

}  // namespace

DocumentReader::DocumentReader(std::FILE* file, std::string name) : file_(file), name_(std::move(name)), buffer_(stream_buffer) {
    std::setvbuf(file_, buffer_.data(), _IOFBF, buffer_.size());
}

bool DocumentReader::read_line(std::string& line) {
    line.clear();
    char* text = nullptr;
    std::size_t capacity = 0;
    errno = 0;
    const ssize_t length = getline(&text, &capacity, file_);
    if (length > 0) line.assign(text, static_cast<std::size_t>(length));
    std::free(text);
    if (std::ferror(file_)) fail(name_, std::string("cannot be read: ") + std::strerror(errno));
    return length > 0;
}

bool DocumentReader::next(Document& document) {
    document = {};
    std::string line;
    do {
        if (!read_line(line)) return false;
    } while (line.find_first_not_of(" \t\r\n") == std::string::npos);
    document.place = name_ + ", document " + std::to_string(++number_);
    document.header = parse_line(line, document.place);
    if (!document.header.is_object()) fail(document.place, "is not a JSON object");

    std::uint64_t bytes = 0;
    if (document.header.contains("bytes")) {
        if (!document.header["bytes"].is_number_unsigned()) fail(document.place, "bytes is not a number of bytes");
        bytes = document.header["bytes"].get<std::uint64_t>();
        if (line.back() != '\n') fail(document.place, "ends inside its header");
    }
    read_payload(document, bytes);
    for (const char* key : {"particles", "bonds", "bytes"}) document.header.erase(key);
    return true;
}

void DocumentReader::read_payload(Document& document, std::uint64_t bytes) {
    std::vector<Slot> slots;
    const auto group = [&](const char* name, std::vector<NamedArray>& arrays) {
        if (!document.header.contains(name)) return false;
        read_group(document.header[name], name, document.place, arrays, slots);
        return true;
    };
    group("particles", document.particles);
    document.has_bonds = group("bonds", document.bonds);

    const std::uint64_t available = bytes_left(file_);
    const auto truncated = [&](std::uint64_t there) {
        fail(document.place, "is truncated: " + std::to_string(bytes) + " bytes belong behind its header, " + std::to_string(there) +
                                 " are there");
    };
    if (bytes > available) truncated(available);

    std::stable_sort(slots.begin(), slots.end(), [](const Slot& a, const Slot& b) { return a.at < b.at; });
    std::uint64_t position = 0;
    const auto take = [&](char* target, std::size_t count) {
        const std::size_t got = std::fread(target, 1, count, file_);
        position += got;
        if (got < count) truncated(position);
    };
    const auto skip_to = [&](std::uint64_t target) {
        std::array<char, 4096> scrap{};
        while (position < target) take(scrap.data(), static_cast<std::size_t>(std::min<std::uint64_t>(scrap.size(), target - position)));
    };
    for (const Slot& slot : slots) {
        const std::size_t values = value_count(slot.array->shape);
        std::visit(
            [&](auto& data) {
                constexpr std::size_t width = sizeof(data[0]);
                if (slot.at > bytes || values > (bytes - slot.at) / width)
                    fail(slot.where, "reaches beyond the " + std::to_string(bytes) + " bytes of the document");
                if (slot.at < position && values > 0) fail(slot.where, "overlaps another array");
                if (values > 0) skip_to(slot.at);
                for (std::size_t done = 0; done < values;) {
                    const std::size_t chunk = std::min(values - done, std::max(first_chunk / width, done));
                    data.resize(done + chunk);
                    take(reinterpret_cast<char*>(data.data() + done), chunk * width);
                    done += chunk;
                }
            },
            slot.array->data);
    }
    skip_to(bytes);
}

}  // namespace kiln::io
