// progress.cpp: the progress line and the JSON lines of -v.
#include "tools/common/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "io/json.h"
#include "tools/common/tool.h"

namespace kiln::cli {

namespace {

constexpr double seconds_between_lines = 0.1;
constexpr double fraction_worth_guessing = 0.01;  // below it the time left is not shown

std::string clock_text(double seconds) {
    const long whole = std::lround(std::max(0.0, seconds));
    char text[32];
    if (whole >= 3600)
        std::snprintf(text, sizeof text, "%ld:%02ld:%02ld", whole / 3600, whole / 60 % 60, whole % 60);
    else
        std::snprintf(text, sizeof text, "%ld:%02ld", whole / 60, whole % 60);
    return text;
}

}  // namespace

Progress::Progress(std::string tool, const Common& common)
    : tool_(std::move(tool)),
      terminal_(isatty(STDERR_FILENO) != 0),
      quiet_(common.quiet),
      verbose_(common.verbose),
      start_(Clock::now()),
      last_(start_) {}

Progress::~Progress() { clear(); }

void Progress::show(double fraction, const std::string& words) {
    if (!terminal_ || quiet_) return;
    const Clock::time_point now = Clock::now();
    if (std::chrono::duration<double>(now - last_).count() < seconds_between_lines) return;
    last_ = now;
    shown_ = true;
    const double elapsed = std::chrono::duration<double>(now - start_).count();
    std::string left;
    if (fraction > fraction_worth_guessing) left = ", " + clock_text(elapsed * (1.0 - fraction) / fraction) + " left";
    std::fprintf(stderr, "\r\033[K%s: %3.0f %%  %s%s", tool_.c_str(), 100.0 * fraction, words.c_str(), left.c_str());
    std::fflush(stderr);
}

void Progress::detail(const Json& details) {
    if (!verbose_ || quiet_) return;
    if (!terminal_) {
        std::fprintf(stderr, "%s\n", details.dump().c_str());
        return;
    }
    clear();
    std::string line = tool_ + ":";
    for (const auto& [key, value] : details.items()) line += " " + key + " " + value.dump();
    std::fprintf(stderr, "%s\n", line.c_str());
}

void Progress::clear() {
    if (!shown_) return;
    std::fprintf(stderr, "\r\033[K");
    std::fflush(stderr);
    shown_ = false;
}

}  // namespace kiln::cli
