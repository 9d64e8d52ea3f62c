// column.h: known arrays between their stream form and the vectors of a state, with the checks of type, shape and value.
#pragma once

#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "io/array_types.h"

namespace kiln::io {

/// Throws Error that starts with where and names the row, `width` values long, of the first value that is NaN or infinite.
template <typename Value>
void require_finite(const std::vector<Value>& values, const std::string& where, std::size_t width) {
    bool finite = true;  // of all values together: a loop without a way out is one that the compiler can vectorise
    for (const Value value : values) finite &= std::abs(value) <= std::numeric_limits<Value>::max();
    for (std::size_t index = 0; !finite; ++index)
        if (!std::isfinite(values[index]))
            throw Error(where + ", row " + std::to_string(index / width) + ": is not a finite number");
}

/// The values of an array, `width` in a row, which must be there in that type, in so many rows, and finite.
template <typename Value>
std::vector<Value> values_of(Array&& array, const std::string& where, std::size_t rows, std::size_t width) {
    auto* values = std::get_if<std::vector<Value>>(&array.data);
    if (!values) {
        const Array required{{}, std::vector<Value>()};
        throw Error(where + " has type " + type_name(array) + ", expected " + type_name(required));
    }
    const std::vector<std::size_t> shape = width == 1 ? std::vector<std::size_t>{rows} : std::vector<std::size_t>{rows, width};
    if (array.shape != shape) throw Error(where + " has shape " + shape_text(array.shape) + ", expected " + shape_text(shape));
    if constexpr (std::is_floating_point_v<Value>) require_finite(*values, where, width);
    return std::move(*values);
}

/// The same for rows of a fixed-size type such as Vec3 or Image.
template <typename Row, typename Value>
std::vector<Row> rows_of(Array&& array, const std::string& where, std::size_t rows) {
    const std::vector<Value> values = values_of<Value>(std::move(array), where, rows, sizeof(Row) / sizeof(Value));
    std::vector<Row> result(rows);
    if (rows > 0) std::memcpy(static_cast<void*>(result.data()), values.data(), values.size() * sizeof(Value));
    return result;
}

/// An array of single values; those of floating point must be finite.
template <typename Value>
NamedArray column(const std::string& name, std::vector<Value>&& values, const std::string& where) {
    if constexpr (std::is_floating_point_v<Value>) require_finite(values, where + name, 1);
    const std::size_t rows = values.size();
    return {name, {{rows}, std::move(values)}};
}

/// An array of rows of a fixed-size type such as Vec3 or Image.
template <typename Value, typename Row>
NamedArray column_of_rows(const std::string& name, const std::vector<Row>& rows, const std::string& where) {
    constexpr std::size_t width = sizeof(Row) / sizeof(Value);
    std::vector<Value> values(rows.size() * width);
    if (!rows.empty()) std::memcpy(values.data(), static_cast<const void*>(rows.data()), values.size() * sizeof(Value));
    if constexpr (std::is_floating_point_v<Value>) require_finite(values, where + name, width);
    return {name, {{rows.size(), width}, std::move(values)}};
}

}  // namespace kiln::io
