// checkpoint.cpp: a checkpoint is a dem-state document of its own, with what the run needs under "checkpoint".
#include "io/checkpoint.h"

#include <cstdio>
#include <filesystem>
#include <utility>

#include "io/files.h"
#include "io/json_values.h"

namespace kiln::io {

namespace {

constexpr const char* key = "checkpoint";
constexpr const char* numbers_key = "sintering";

void mix(std::uint64_t& hash, const void* data, std::size_t bytes) {
    const auto* byte = static_cast<const unsigned char*>(data);
    for (std::size_t k = 0; k < bytes; ++k) hash = (hash ^ byte[k]) * 0x100000001b3ULL;  // FNV-1a, 64 bits: Fowler, Noll & Vo 1991
}

}  // namespace

std::string fingerprint(const State& state) {
    std::uint64_t hash = 0xcbf29ce484222325ULL;
    mix(hash, state.particles.position.data(), state.particles.position.size() * sizeof(Vec3));
    mix(hash, state.particles.radius.data(), state.particles.radius.size() * sizeof(double));
    mix(hash, state.box.lengths.data(), sizeof(Vec3));
    char text[17];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
    return text;
}

void Checkpoint::require_input(const std::string& fingerprint) const {
    if (fingerprint != run.fingerprint) throw Error("the checkpoint is of another input");
}

CheckpointFile::CheckpointFile(std::string file, bool resume, double interval, Json arguments)
    : file_(std::move(file)), resume_(resume), interval_(interval), arguments_(std::move(arguments)) {}

std::optional<Checkpoint> CheckpointFile::read() const {
    if (!requested() || !resume_ || !std::filesystem::exists(file_)) return std::nullopt;
    Input input({file_});
    Checkpoint checkpoint{.state = std::move(*input.next_state()), .numbers = {}, .run = {}};
    const Json carried = carried_json(checkpoint.state.other, file_);
    if (!carried.contains(key) || !carried.contains(numbers_key)) throw Error(file_ + ": is no checkpoint of sinter");
    const Json& own = carried[key];
    try {
        checkpoint.numbers = carried[numbers_key].get<decltype(checkpoint.numbers)>();
        if (own.at("arguments") != arguments_)
            throw Error(file_ + ": is of a run with other options, " + own.at("arguments").dump() + "; delete it to begin anew");
        checkpoint.run = {.document = own.at("document"),
                          .fingerprint = own.at("fingerprint"),
                          .output_bytes = own.at("output_bytes"),
                          .history_bytes = own.at("history_bytes"),
                          .newton = own.at("newton"),
                          .conjugate_gradients = own.at("conjugate_gradients"),
                          .converged = own.at("converged"),
                          .finished = own.at("finished")};
    } catch (const Json::exception& error) {
        throw Error(file_ + ": is no checkpoint of sinter: " + error.what());
    }
    return checkpoint;
}

bool CheckpointFile::due(Clock::time_point now) const {
    return requested() && std::chrono::duration<double>(now - last_).count() >= interval_;
}

void CheckpointFile::write(Checkpoint checkpoint) {
    const RunState& run = checkpoint.run;
    Json carried = carried_json(checkpoint.state.other, file_);
    check_finite(Json(checkpoint.numbers), file_);
    carried[numbers_key] = checkpoint.numbers;
    carried[key] = {{"document", run.document},
                    {"fingerprint", run.fingerprint},
                    {"arguments", arguments_},
                    {"output_bytes", run.output_bytes},
                    {"history_bytes", run.history_bytes},
                    {"newton", run.newton},
                    {"conjugate_gradients", run.conjugate_gradients},
                    {"converged", run.converged},
                    {"finished", run.finished}};
    checkpoint.state.other = text_of(carried);
    Output output(file_, false, Resumption{.take_up = true});  // a checkpoint that kill -9 interrupted is written over
    output.write(std::move(checkpoint.state));
    output.commit();
    last_ = Clock::now();
}

void CheckpointFile::remove() const {
    if (requested()) std::filesystem::remove(file_);
}

}  // namespace kiln::io
