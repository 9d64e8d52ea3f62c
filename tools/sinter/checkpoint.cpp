// checkpoint.cpp: a checkpoint is a dem-state document of its own, with what the run needs under "checkpoint".
#include "tools/sinter/checkpoint.h"

#include <cstring>
#include <filesystem>

#include "io/json_values.h"

namespace kiln::sinter {

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

Checkpoint::Checkpoint(const Options& options, Json arguments)
    : file_(options.checkpoint), resume_(options.resume), interval_(options.checkpoint_every), arguments_(std::move(arguments)) {}

std::optional<RunState> Checkpoint::read() {
    if (!requested() || !resume_ || !std::filesystem::exists(file_)) return std::nullopt;
    io::Input input({file_});
    checkpoint_ = {.state = std::move(*input.next_state()), .numbers = {}};
    const Json carried = io::carried_json(checkpoint_->state.other, file_);
    if (!carried.contains(key) || !carried.contains(numbers_key)) throw Error(file_ + ": is no checkpoint of sinter");
    const Json& own = carried[key];
    try {
        checkpoint_->numbers = carried[numbers_key].get<sintering::Numbers>();
        if (own.at("arguments") != arguments_)
            throw Error(file_ + ": is of a run with other options, " + own.at("arguments").dump() + "; delete it to begin anew");
        return RunState{.document = own.at("document"),
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
}

bool Checkpoint::due() const { return requested() && std::chrono::duration<double>(Clock::now() - last_).count() >= interval_; }

void Checkpoint::write(sintering::Checkpoint checkpoint, const RunState& run_state) {
    Json carried = io::carried_json(checkpoint.state.other, file_);
    io::check_finite(Json(checkpoint.numbers), file_);
    carried[numbers_key] = checkpoint.numbers;
    carried[key] = {{"document", run_state.document},
                        {"fingerprint", run_state.fingerprint},
                        {"arguments", arguments_},
                        {"output_bytes", run_state.output_bytes},
                        {"history_bytes", run_state.history_bytes},
                        {"newton", run_state.newton},
                        {"conjugate_gradients", run_state.conjugate_gradients},
                        {"converged", run_state.converged},
                        {"finished", run_state.finished}};
    checkpoint.state.other = io::text_of(carried);
    io::Output output(file_, false, io::Resumption{.take_up = true});  // a checkpoint that kill -9 interrupted is written over
    output.write(std::move(checkpoint.state));
    output.commit();
    last_ = Clock::now();
}

void Checkpoint::remove() const {
    if (requested()) std::filesystem::remove(file_);
}

}  // namespace kiln::sinter
