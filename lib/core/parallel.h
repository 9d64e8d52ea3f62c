// parallel.h: loops over rows and chunks whose results do not depend on the number of threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace kiln {

/// Rows from which a light pass over them takes longer than waking and joining threads.
inline constexpr std::size_t worth_threads = 8192;

/// Calls work(row) for each row, in any order; worth: rows from which threads share the work.
template <typename Work>
void for_rows(std::size_t rows, const Work& work, std::size_t worth = worth_threads) {
    const auto count = static_cast<std::int64_t>(rows);
#pragma omp parallel for schedule(static) if (rows >= worth)
    for (std::int64_t row = 0; row < count; ++row) work(static_cast<std::size_t>(row));
}

/// Calls work(chunk) for each chunk, in any order, handed out as threads are free; fewest: chunks from which threads share the
/// work.
template <typename Work>
void for_chunks(std::size_t chunks, const Work& work, std::size_t fewest = 2) {
    const auto count = static_cast<std::int64_t>(chunks);
#pragma omp parallel for schedule(dynamic) if (chunks >= fewest)
    for (std::int64_t chunk = 0; chunk < count; ++chunk) work(static_cast<std::size_t>(chunk));
}

/// Sum of value(chunk) over the chunks, in their order. Sum is a type that `Sum total = value(0); total += value(1)` works for.
template <typename Sum, typename Value>
Sum sum_chunks(std::size_t chunks, const Sum& zero, const Value& value, std::size_t fewest = 2) {
    std::vector<Sum> parts(chunks, zero);
    for_chunks(chunks, [&](std::size_t chunk) { parts[chunk] = value(chunk); }, fewest);
    Sum total = zero;
    for (const Sum& part : parts) total += part;
    return total;
}

}  // namespace kiln
