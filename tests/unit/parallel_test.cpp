// Loops on several threads: every piece once, whatever comes together.
#include "core/parallel.h"

#include <doctest/doctest.h>

#include <atomic>
#include <functional>
#include <string>
#include <thread>

#include "core/types.h"

using namespace kiln;

namespace {

struct Threads {
    explicit Threads(int count) : before(threads()) { set_threads(count); }
    ~Threads() { set_threads(before); }
    int before;
};

/// How often each chunk was done.
std::vector<int> visits(std::size_t chunks) {
    std::vector<int> count(chunks, 0);
    for_chunks(chunks, [&](std::size_t chunk) { ++count[chunk]; });
    return count;
}

}  // namespace

TEST_CASE("parallel: every chunk and every row once, for any number of threads") {
    for (const int count : {1, 2, 3, 8}) {
        const Threads few(count);
        CHECK(threads() == count);
        for (const std::size_t size : {0U, 1U, 2U, 3U, 7U, 100U, 1001U}) {
            CHECK(visits(size) == std::vector<int>(size, 1));
            std::vector<int> rows(size, 0);
            for_rows(size, [&](std::size_t row) { ++rows[row]; }, 2);
            CHECK(rows == std::vector<int>(size, 1));
        }
    }
}

TEST_CASE("parallel: short loops in quick succession take no piece of each other") {
    const Threads four(4);
    std::size_t wrong = 0;
    for (std::size_t loop = 0; loop < 20000; ++loop) {
        const std::size_t size = 2 + loop * 7919 % 23;
        std::vector<std::size_t> seen(size, 0);
        for_chunks(size, [&](std::size_t chunk) { seen[chunk] += loop + chunk; });
        for (std::size_t chunk = 0; chunk < size; ++chunk) wrong += seen[chunk] != loop + chunk;
    }
    CHECK(wrong == 0);
}

TEST_CASE("parallel: sums are taken in order, so that not a bit depends on the threads") {
    const auto sum = [] {
        return sum_chunks(1000, 0.0, [](std::size_t chunk) { return 1.0 / (1.0 + 0.37 * static_cast<double>(chunk)); });
    };
    double one = 0.0, five = 0.0;
    { const Threads alone(1); one = sum(); }
    { const Threads several(5); five = sum(); }
    CHECK(one == five);
    const Threads several(3);
    CHECK(greatest_of_rows(50000, 0.0, [](std::size_t row) { return static_cast<double>(row * 7919 % 50000); }, 2) == 49999.0);
    CHECK(join_rows(50000, std::size_t{0}, [](std::size_t row) { return row % 2; }, std::plus(), 2) == 25000);
    CHECK(join_rows(0, 4.0, [](std::size_t) { return 1.0; }, std::plus(), 2) == 4.0);
}

TEST_CASE("parallel: of several errors that of the first piece is thrown, when all pieces are done") {
    const Threads four(4);
    for (int time = 0; time < 20; ++time) {
        std::atomic<int> done{0};
        std::string message;
        try {
            for_chunks(64, [&](std::size_t chunk) {
                ++done;
                if (chunk % 3 == 2) throw Error("piece " + std::to_string(chunk));
            });
        } catch (const Error& error) {
            message = error.what();
        }
        CHECK(message == "piece 2");
        CHECK(done == 64);
    }
    CHECK(visits(9) == std::vector<int>(9, 1));  // the team goes on
}

TEST_CASE("parallel: loops within loops and loops of several threads of the program") {
    const Threads three(3);
    std::vector<int> inner(12 * 50, 0);
    for_chunks(12, [&](std::size_t outer) { for_chunks(50, [&](std::size_t chunk) { ++inner[50 * outer + chunk]; }); });
    CHECK(inner == std::vector<int>(12 * 50, 1));
    std::vector<std::vector<int>> of_thread(4);
    {
        std::vector<std::jthread> callers;
        for (std::vector<int>& mine : of_thread)
            callers.emplace_back([&mine] { for (int time = 0; time < 50; ++time) mine = visits(200); });
    }
    for (const std::vector<int>& mine : of_thread) CHECK(mine == std::vector<int>(200, 1));
}
