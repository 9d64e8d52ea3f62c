// stop.h: how long work is asked to end early, the same way everywhere in the library.
#pragma once

#include <exception>
#include <functional>

namespace kiln {

/// Long work asks this from one thread, several times a second: true means that it should end. Empty: nobody will ask it to.
using StopRequest = std::function<bool()>;

/// A stop was requested and there is no result to give; what was being changed may be half done.
struct Interrupted : std::exception {
    const char* what() const noexcept override { return "a stop was requested"; }
};

/// Throws Interrupted if a stop is requested.
inline void throw_if_stopped(const StopRequest& stop) {
    if (stop && stop()) throw Interrupted();
}

/// What long work hears and says on its way. Both may be empty.
struct Watch {
    StopRequest stop;
    std::function<void(double)> progress;  // told the fraction of the work that is done, 0 to 1

    /// The work has come so far. Throws Interrupted if a stop is requested.
    void at(double fraction) const {
        if (progress) progress(fraction);
        throw_if_stopped(stop);
    }
};

}  // namespace kiln
