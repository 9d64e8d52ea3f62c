// array_types.cpp: type names in the order of the alternatives of Array::Data.
#include "io/array_types.h"

#include <array>

#include "io/json.h"
#include "io/json_values.h"

namespace kiln::io {

namespace {

constexpr std::array names{"f8", "f4", "i8", "i4", "i2", "i1", "u1"};
static_assert(names.size() == std::variant_size_v<Array::Data>);

template <std::size_t Index = 0>
bool set_alternative(Array::Data& data, std::size_t required) {
    if constexpr (Index == names.size()) {
        return false;
    } else {
        if (Index == required) {
            data.emplace<Index>();
            return true;
        }
        return set_alternative<Index + 1>(data, required);
    }
}

}  // namespace

bool set_type(Array& array, const std::string& name) {
    for (std::size_t index = 0; index < names.size(); ++index)
        if (name == names[index]) return set_alternative(array.data, index);
    return false;
}

std::string type_name(const Array& array) { return names[array.data.index()]; }

std::string shape_text(const std::vector<std::size_t>& shape) { return shown(Json(shape)); }

std::string known_types() {
    std::string list;
    for (const char* name : names) list += (list.empty() ? "" : ", ") + std::string(name);
    return list;
}

}  // namespace kiln::io
