// progress.h: progress of long work on stderr, with the time left; only words on a terminal, JSON lines with -v elsewhere.
#pragma once

#include <chrono>
#include <string>

#include "io/json_forward.h"

namespace kiln::cli {

struct Common;

class Progress {
   public:
    Progress(std::string tool, const Common& common);
    ~Progress();

    /// fraction in [0, 1] of the work done. On a terminal: one line, rewritten at most ten times a second, with the time left.
    void show(double fraction, const std::string& words);

    /// With -v: `details` as words on a terminal, as a JSON line elsewhere.
    void detail(const Json& details);

    /// Wipes the line.
    void clear();

   private:
    using Clock = std::chrono::steady_clock;
    std::string tool_;
    bool terminal_, quiet_, verbose_, shown_ = false;
    Clock::time_point start_, last_;
};

}  // namespace kiln::cli
