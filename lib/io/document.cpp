// document.cpp: reading one document of a stream; every size is checked before memory is taken.
#include "io/document.h"

#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <limits>
#include <memory>

#include "io/array_types.h"
#include "io/files.h"
#include "io/json_line.h"
#include "io/json_values.h"

namespace kiln::io {

namespace {

constexpr std::size_t first_chunk = 1 << 20;                     // bytes of an array taken before its arrival is seen
constexpr std::size_t max_size = std::size_t{1} << 31;       // rows are counted by i4
constexpr std::uint64_t unknown_length = std::numeric_limits<std::uint64_t>::max();

[[noreturn]] void fail(const std::string& place, const std::string& cause) { throw Error(place + ": " + cause); }

std::vector<std::size_t> shape_from(const Json& spec, const std::string& where) {
    if (!spec.contains("shape") || !spec["shape"].is_array() || spec["shape"].empty())
        fail(where, "has no shape, a list of sizes such as [N,3]");
    std::vector<std::size_t> shape;
    std::size_t values = 1;
    for (const Json& size : spec["shape"]) {
        if (!size.is_number_integer() || size.get<std::int64_t>() < 0 || size.get<std::uint64_t>() >= max_size)
            fail(where, "shape " + shown(spec["shape"]) + " is not a list of sizes");
        shape.push_back(size.get<std::size_t>());
        if (__builtin_mul_overflow(values, shape.back(), &values) || values > std::numeric_limits<std::int64_t>::max() / 8)
            fail(where, "shape " + shown(spec["shape"]) + " is larger than any memory");
    }
    return shape;
}

std::size_t value_count(const std::vector<std::size_t>& shape) {
    std::size_t values = 1;
    for (const std::size_t size : shape) values *= size;
    return values;
}

std::size_t value_width(const Array& array) {
    return std::visit([](const auto& values) { return sizeof(values[0]); }, array.data);
}

template <typename Value>
Value value_from(const Json& item, const std::string& where, std::size_t index) {
    const auto refuse = [&](const std::string& required) -> void {
        fail(where, "value " + std::to_string(index) + " is " + shown(item) + " where " + required + " is needed");
    };
    if constexpr (std::is_floating_point_v<Value>) {
        if (!item.is_number()) refuse("a number");
        if (std::abs(item.get<double>()) > std::numeric_limits<Value>::max()) refuse("a number that fits the array's type");
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
    const std::size_t required = value_count(array.shape);
    if (!data.is_array() || data.size() != required)
        fail(where, "has " + std::to_string(data.is_array() ? data.size() : 0) + " values of data where its shape requires " +
                        std::to_string(required));
    std::visit(
        [&](auto& values) {
            using Value = typename std::decay_t<decltype(values)>::value_type;
            values.reserve(required);
            for (const Json& item : data) values.push_back(value_from<Value>(item, where, values.size()));
        },
        array.data);
}

/// Bytes from here to the end of a regular file; nobody knows for a pipe.
std::uint64_t bytes_left(std::FILE* file) {
    struct stat status {};
    const long here = std::ftell(file);
    if (here < 0 || fstat(fileno(file), &status) != 0 || !S_ISREG(status.st_mode)) return unknown_length;
    return static_cast<std::uint64_t>(std::max<off_t>(0, status.st_size - here));
}

/// An array in the payload: where it stands and where it goes.
struct Slot {
    std::uint64_t at;
    std::string where;
    Array* array;
};

/// The bytes behind a header, read from front to back.
class Payload {
   public:
    /// Throws Error at once where a file is shorter than that.
    Payload(std::FILE* file, const std::string& place, std::uint64_t bytes)
        : file_(file), place_(place), bytes_(bytes), left_(bytes_left(file)) {
        if (bytes_ > left_) truncated(left_);
    }

    void skip_to(std::uint64_t target) {
        std::array<char, 4096> scrap;
        while (position_ < target) take(scrap.data(), std::min<std::uint64_t>(scrap.size(), target - position_));
    }

    /// Fills the array. Of a pipe no more memory is taken at a time than bytes have arrived already.
    void read(const Slot& slot) {
        if (slot.at < position_) fail(slot.where, "overlaps another array");
        skip_to(slot.at);
        const std::size_t values = value_count(slot.array->shape);
        const auto fill = [&](auto& data) {
            constexpr std::size_t width = sizeof(data[0]);
            for (std::size_t done = 0; done < values;) {
                const std::size_t chunk = left_ == unknown_length ? std::max(first_chunk / width, done) : values;
                data.resize(std::min(values, done + chunk));
                take(data.data() + done, (data.size() - done) * width);
                done = data.size();
            }
        };
        std::visit(fill, slot.array->data);
    }

   private:
    void take(void* target, std::size_t count) {
        const std::size_t got = std::fread(target, 1, count, file_);
        position_ += got;
        if (got == count) return;
        if (std::ferror(file_)) throw_system_error(place_ + ": cannot be read");
        truncated(position_);
    }

    [[noreturn]] void truncated(std::uint64_t there) const {
        fail(place_, "is truncated: " + std::to_string(bytes_) + " bytes belong behind its header, " + std::to_string(there) +
                         " are there");
    }

    std::FILE* file_;
    const std::string& place_;
    std::uint64_t bytes_, left_, position_ = 0;
};

/// Arrays of one group ("particles", "bonds" or "necks"): text data is read, payload arrays are noted in slots.
void read_group(const Json& group, const std::string& name, const std::string& place, std::vector<NamedArray>& arrays,
                std::vector<Slot>& slots) {
    arrays.reserve(group.size());
    for (const auto& [key, spec] : group.items()) {
        const std::string where = place + ": " + name + "." + clipped(key);
        if (!spec.is_object() || !spec.contains("type") || !spec["type"].is_string())
            fail(where, "is not an array {\"type\":…,\"shape\":…,\"data\" or \"at\":…}");
        NamedArray& named = arrays.emplace_back(NamedArray{key, {shape_from(spec, where), {}}});
        if (!set_type(named.array, spec["type"].get<std::string>()))
            fail(where, "type " + shown(spec["type"]) + " is unknown; there are " + known_types());
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

DocumentReader::DocumentReader(std::FILE* file, std::string name) : file_(file), name_(std::move(name)) {}

void DocumentReader::check_readable() const {
    if (std::ferror(file_)) throw_system_error(name_ + ": cannot be read");
}

/// Moves to the first byte of the next document; false at the end of the stream.
bool DocumentReader::find_document() {
    int first = std::getc(file_);
    while (first == ' ' || first == '\t' || first == '\r' || first == '\n') first = std::getc(file_);
    check_readable();
    if (first == EOF) return false;
    std::ungetc(first, file_);
    return true;
}

Json DocumentReader::read_header(const std::string& place) {
    const int first = std::getc(file_);  // looked at before a line is read: what is no stream at all may hold no line end either
    if (first == 0x1f) fail(place, "is compressed (gzip), expected a JSON object; unpack it first, as gunzip does");
    if (first != '{') fail(place, "begins with byte " + std::to_string(first) + ", expected '{', the beginning of a JSON object");
    std::ungetc(first, file_);
    char* text = nullptr;
    std::size_t capacity = 0;
    const ssize_t length = getline(&text, &capacity, file_);
    const std::unique_ptr<char, decltype(&std::free)> owner(text, &std::free);
    check_readable();
    if (length <= 0) throw std::bad_alloc();
    const std::string_view line(text, static_cast<std::size_t>(length));
    const std::size_t last = line.find_last_not_of(" \t\r\n");
    const bool whole = line.back() == '\n';
    if (!whole && line[last] != '}')
        fail(place, "is truncated: it ends inside its header, after " + std::to_string(length) + " bytes");
    Json header = parse_line(line, place);
    if (!whole && header.contains("bytes")) fail(place, "is truncated: it ends with its header, but bytes belong behind it");
    return header;
}

bool DocumentReader::next(Document& document) {
    document = {};
    errno = 0;
    if (!find_document()) return false;
    document.place = name_ + ", document " + std::to_string(++number_);
    document.header = read_header(document.place);

    std::uint64_t bytes = 0;
    if (document.header.contains("bytes")) {
        const Json& size = document.header["bytes"];
        if (!size.is_number_unsigned()) fail(document.place, "bytes is " + shown(size) + ", not a number of bytes");
        bytes = size.get<std::uint64_t>();
        document.header.erase("bytes");
    }
    read_arrays(document, bytes);
    return true;
}

void DocumentReader::read_arrays(Document& document, std::uint64_t bytes) {
    std::vector<Slot> slots;
    const auto group = [&](const char* name, std::vector<NamedArray>& arrays) {
        if (!document.header.contains(name) || !document.header[name].is_object()) return false;
        read_group(document.header[name], name, document.place, arrays, slots);
        document.header.erase(name);
        return true;
    };
    group("particles", document.particles);
    document.has_bonds = group("bonds", document.bonds);
    document.has_necks = group("necks", document.necks);
    for (const Slot& slot : slots) {
        const std::uint64_t width = value_width(*slot.array);
        if (slot.at > bytes || value_count(slot.array->shape) > (bytes - slot.at) / width)
            fail(slot.where, "reaches beyond the " + std::to_string(bytes) + " bytes of the document");
    }
    std::stable_sort(slots.begin(), slots.end(), [](const Slot& a, const Slot& b) { return a.at < b.at; });
    Payload payload(file_, document.place, bytes);
    for (const Slot& slot : slots)
        if (value_count(slot.array->shape) > 0) payload.read(slot);
    payload.skip_to(bytes);
}

}  // namespace kiln::io
