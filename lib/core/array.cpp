// array.cpp: row selection for arrays of any type and shape.
#include "core/array.h"

namespace kiln {

std::size_t Array::row_length() const {
    std::size_t length = 1;
    for (std::size_t axis = 1; axis < shape.size(); ++axis) length *= shape[axis];
    return length;
}

Array take_rows(const Array& array, std::span<const std::int32_t> rows) {
    Array taken;
    taken.shape = array.shape;
    taken.shape.at(0) = rows.size();
    const std::size_t width = array.row_length();
    taken.data = std::visit(
        [&](const auto& source) -> Array::Data {
            std::decay_t<decltype(source)> target;
            target.reserve(rows.size() * width);
            for (const std::int32_t row : rows) {
                const auto first = source.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(row) * width);
                target.insert(target.end(), first, first + static_cast<std::ptrdiff_t>(width));
            }
            return target;
        },
        array.data);
    return taken;
}

}  // namespace kiln
