// checkpoint.h: files from which an interrupted run is resumed.
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "io/files.h"
#include "sintering/sintering.h"
#include "tools/sinter/options.h"

namespace kiln::sinter {

/// Where a run was when its checkpoint was written, besides the state itself.
struct RunState {
    std::size_t document = 0;          // of the input, from 0
    std::string fingerprint;           // of that document as it was read
    std::uint64_t output_bytes = 0, history_bytes = 0;
    int newton = 0, conjugate_gradients = 0;
    bool converged = true;
    bool finished = false;             // only the renaming was left
};

/// A number that tells one packing from another: FNV-1a over positions, radii and box.
std::string fingerprint(const State& state);

/// Writes and reads the checkpoint of a run. Does nothing without --checkpoint.
class Checkpoint {
   public:
    Checkpoint(const Options& options, Json arguments);

    bool requested() const { return !file_.empty(); }

    /// What the file says, if --resume was given and the file is there. Throws Error where other options were given then.
    std::optional<RunState> read();

    /// Where to go on from, once read() has found one.
    const sintering::Checkpoint& found() const { return *checkpoint_; }

    /// True when the next checkpoint is due by the wall clock.
    bool due() const;

    void write(sintering::Checkpoint checkpoint, const RunState& run_state);

    /// Takes the file away at the end of the run.
    void remove() const;

   private:
    using Clock = std::chrono::steady_clock;
    std::string file_;
    bool resume_;
    double interval_;  // s
    Json arguments_;
    std::optional<sintering::Checkpoint> checkpoint_;
    Clock::time_point last_ = Clock::now();
};

}  // namespace kiln::sinter
