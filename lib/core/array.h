// array.h: a typed array of any shape, for the columns of a state that a tool does not know by name.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "core/types.h"

namespace kiln {

struct Array {
    using Data = std::variant<std::vector<double>, std::vector<float>, std::vector<std::int64_t>,
                              std::vector<std::int32_t>, std::vector<std::int16_t>, std::vector<std::int8_t>,
                              std::vector<std::uint8_t>>;
    std::vector<std::size_t> shape;  // first entry: rows; the product is the length of data
    Data data;

    std::size_t rows() const { return shape.empty() ? 0 : shape.front(); }
    /// Values in one row.
    std::size_t row_length() const;
};

struct NamedArray {
    std::string name;
    Array array;
};

/// The array's rows in the given order (repeats allowed).
Array take_rows(const Array& array, std::span<const std::int32_t> rows);

}  // namespace kiln
