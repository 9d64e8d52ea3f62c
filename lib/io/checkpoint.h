// checkpoint.h: the file from which an interrupted run of sinter is resumed.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/state.h"
#include "io/json.h"

namespace kiln::io {

/// Where a run was when its checkpoint was written, besides the state itself.
struct RunState {
    std::size_t document = 0;          // of the input, from 0
    std::string fingerprint;           // of that document as it was read
    std::uint64_t output_bytes = 0, history_bytes = 0;
    int newton = 0, conjugate_gradients = 0;
    bool converged = true;
    bool finished = false;             // only the renaming was left
};

/// All that a run needs to go on.
struct Checkpoint {
    State state;  // particles in working order, with arrays of the method among the unknown ones
    std::map<std::string, std::vector<double>> numbers;  // of the method, by name
    RunState run;

    /// Throws Error unless the run was one of the document with this fingerprint.
    void require_input(const std::string& fingerprint) const;
};

/// A number that tells one packing from another: FNV-1a over positions, radii and box.
std::string fingerprint(const State& state);

/// Writes and reads the checkpoint of a run. Does nothing where it has no name.
class CheckpointFile {
   public:
    using Clock = std::chrono::steady_clock;

    /// file: its name, or empty. resume: whether to look for an earlier run's. interval: between two checkpoints, s of wall time.
    /// arguments: those that bear on the result; only a run with the same ones is resumed.
    CheckpointFile(std::string file, bool resume, double interval, Json arguments);

    bool requested() const { return !file_.empty(); }

    /// What the file says, if the run is to be resumed and the file is there. Throws Error that begins with the name of the file
    /// where it cannot be read, is no checkpoint, or is of a run with other arguments.
    std::optional<Checkpoint> read() const;

    /// True when the next checkpoint is due: the interval has passed since the last one, or since the beginning.
    bool due(Clock::time_point now = Clock::now()) const;

    /// Puts a checkpoint in the place of the one before, which stays until the new one is whole. Throws Error where it cannot be
    /// written or a number in it is not finite.
    void write(Checkpoint checkpoint);

    /// Takes the file away at the end of the run.
    void remove() const;

   private:
    std::string file_;
    bool resume_;
    double interval_;  // s
    Json arguments_;
    Clock::time_point last_ = Clock::now();
};

}  // namespace kiln::io
