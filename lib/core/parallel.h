// parallel.h: loops over rows and chunks on a few threads, whose results do not depend on the number of threads.
//
// Each thread has a contiguous part of the work, so that from loop to loop it meets the same memory, and takes of the others'
// parts when it is done with its own. A loop waits only for what another thread has begun: one that the system does not let run
// holds nothing up, its part is done by the rest.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace kiln {

/// Rows from which a light pass over them takes longer than waking threads.
inline constexpr std::size_t worth_threads = 8192;

/// Threads that share a loop, the calling one included; at first as many as there are processors for this process.
int threads();

/// count: at least 1. Not while a loop runs.
void set_threads(int count);

/// Calls work(context, piece) for each piece on all threads. Where pieces throw, the exception of the first of them is thrown when
/// all are done. Within a loop, or where another thread of the program is in one, the pieces are done one after the other.
void share_pieces(std::size_t pieces, void (*work)(const void* context, std::size_t piece), const void* context);

/// Calls work(chunk) for each chunk, in any order; fewest: chunks from which threads share the work.
template <typename Work>
void for_chunks(std::size_t chunks, const Work& work, std::size_t fewest = 2) {
    if (chunks < fewest || threads() == 1) {
        for (std::size_t chunk = 0; chunk < chunks; ++chunk) work(chunk);
        return;
    }
    share_pieces(
        chunks, [](const void* context, std::size_t chunk) { (*static_cast<const Work*>(context))(chunk); },
        std::addressof(work));
}

/// Calls work(row) for each row, in any order; worth: rows from which threads share the work.
template <typename Work>
void for_rows(std::size_t rows, const Work& work, std::size_t worth = worth_threads) {
    constexpr std::size_t shares = 8;  // of each thread, that others may take over
    const std::size_t pieces = rows < worth ? 1 : std::min(rows, shares * static_cast<std::size_t>(threads()));
    for_chunks(pieces, [&](std::size_t piece) {
        const std::size_t last = rows * (piece + 1) / pieces;
        for (std::size_t row = rows * piece / pieces; row < last; ++row) work(row);
    });
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

/// join(... join(join(start, value(0)), value(1)) ..., value(rows - 1)) for a join to which the order does not matter, such as the
/// greater of two or the sum of whole numbers.
template <typename Result, typename Value, typename Join>
Result join_rows(std::size_t rows, const Result& start, const Value& value, const Join& join, std::size_t worth = worth_threads) {
    constexpr std::size_t in_chunk = 2048;
    std::vector<Result> parts((rows + in_chunk - 1) / in_chunk, start);
    for_chunks(parts.size(), [&](std::size_t chunk) {
        Result part = start;
        const std::size_t last = std::min(rows, (chunk + 1) * in_chunk);
        for (std::size_t row = chunk * in_chunk; row < last; ++row) part = join(part, value(row));
        parts[chunk] = part;
    }, worth / in_chunk);
    Result all = start;
    for (const Result& part : parts) all = join(all, part);
    return all;
}

/// The greatest of value(row) and `least`.
template <typename Value>
double greatest_of_rows(std::size_t rows, double least, const Value& value, std::size_t worth = worth_threads) {
    return join_rows(rows, least, value, [](double a, double b) { return std::max(a, b); }, worth);
}

}  // namespace kiln
