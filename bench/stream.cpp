// stream.cpp: speed of lib/io with 100,000 particles x 8 doubles, to and from a file in the disk cache and a pipe, beside memcpy.
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <functional>
#include <thread>

#include "io/files.h"
#include "io/state_io.h"

namespace {

using namespace kiln;

constexpr std::size_t particles = 100000;
constexpr double seconds_a_case = 0.5;  // time for which each case is repeated

/// Position, radius and four more doubles a particle; id and material come on top, as in every state.
State example() {
    State state;
    state.box.lengths = {1.0, 1.0, 1.0};
    state.materials.resize(1);
    state.materials[0].name = "alumina";
    for (std::size_t row = 0; row < particles; ++row) {
        const double value = static_cast<double>(row + 1) / particles;
        state.particles.id.push_back(static_cast<std::int64_t>(row));
        state.particles.position.emplace_back(value, 0.5 * value, 0.1);
        state.particles.radius.push_back(value);
        state.particles.material.push_back(0);
    }
    state.particles.other = {{"velocity", {{particles, 3}, std::vector<double>(3 * particles, 0.25)}},
                             {"energy", {{particles}, std::vector<double>(particles, 0.5)}}};
    return state;
}

/// Best time of one call, s; the first call, which meets cold memory, is not counted.
double best_seconds(const std::function<void()>& action) {
    using Clock = std::chrono::steady_clock;
    const auto seconds_since = [](Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); };
    action();
    double best = 1e9;
    for (const Clock::time_point start = Clock::now(); seconds_since(start) < seconds_a_case;) {
        const Clock::time_point begin = Clock::now();
        action();
        best = std::min(best, seconds_since(begin));
    }
    return best;
}

void report(const char* name, std::size_t bytes, double seconds) {
    const Json line{{"bench", "stream"}, {"case", name}, {"bytes", bytes}, {"seconds", seconds},
                    {"gigabytes_per_second", 1e-9 * static_cast<double>(bytes) / seconds}};
    std::puts(line.dump().c_str());
}

void write_state(const std::string& path, const State& state) {
    io::Output output(path, false);
    output.write(state);
    output.commit();
}

void read_state(const std::string& path) {
    io::Input input({path});
    while (input.next_state()) continue;
}

/// The other end of a named pipe: takes or gives bytes without looking at them, as cat would.
void drain(const std::string& path, std::vector<char>& buffer) {
    const int file = open(path.c_str(), O_RDONLY);
    while (read(file, buffer.data(), buffer.size()) > 0) continue;
    close(file);
}

void feed(const std::string& path, const std::vector<char>& bytes, int flags = 0) {
    const int file = open(path.c_str(), O_WRONLY | O_TRUNC | flags, 0600);
    for (std::size_t done = 0; done < bytes.size();) {
        const ssize_t written = write(file, bytes.data() + done, bytes.size() - done);
        if (written <= 0) break;
        done += static_cast<std::size_t>(written);
    }
    close(file);
}

}  // namespace

int main() {
    io::keep_freed_memory();  // as in the tools
    const std::filesystem::path folder = std::filesystem::temp_directory_path() / ("kiln-bench-" + std::to_string(getpid()));
    std::filesystem::create_directory(folder);
    const std::string file = folder / "state", pipe = folder / "pipe";
    if (mkfifo(pipe.c_str(), 0600) != 0) return 1;

    const State state = example();
    write_state(file, state);
    const std::size_t size = std::filesystem::file_size(file);
    std::vector<char> source(size, 'x'), target(size);

    report("memcpy", size, best_seconds([&] { std::memcpy(target.data(), source.data(), size); }));
    report("memcpy to fresh memory", size, best_seconds([&] {
               void* fresh = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
               std::memcpy(fresh, source.data(), size);
               munmap(fresh, size);
           }));
    report("copy to file", size, best_seconds([&] { feed(file, source, O_CREAT); }));
    report("write file", size, best_seconds([&] { write_state(file, state); }));
    report("read file", size, best_seconds([&] { read_state(file); }));
    report("write pipe", size, best_seconds([&] {
               std::thread other([&] { drain(pipe, target); });
               write_state(pipe, state);
               other.join();
           }));
    std::FILE* stored = std::fopen(file.c_str(), "rb");
    source.resize(std::fread(source.data(), 1, size, stored));
    std::fclose(stored);
    report("read pipe", size, best_seconds([&] {
               std::thread other([&] { feed(pipe, source); });
               read_state(pipe);
               other.join();
           }));
    report("copy through pipe", size, best_seconds([&] {
               std::thread other([&] { feed(pipe, source); });
               drain(pipe, target);
               other.join();
           }));
    std::filesystem::remove_all(folder);
}
