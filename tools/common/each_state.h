// each_state.h: the loop over the states or documents of a run's input; every error says which of them it is about.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "io/files.h"

namespace kiln::cli {

/// What work() gives. An Error that it throws gets "place: " in front, unless it names a file or document of its own.
template <typename Work>
auto at_place(const std::string& place, const Work& work) {
    try {
        return work();
    } catch (const io::PlacedError&) {
        throw;
    } catch (const Error& error) {
        throw Error(place + ": " + error.what());
    }
}

/// The next document of the input; nothing at the end. Of several processes the first one reads it for all: what it cannot read
/// ends the others as a stop does.
std::optional<io::Document> next_document(io::Input& input);

/// Calls work(document) for each document of the input.
void for_each_document(io::Input& input, const std::function<void(io::Document)>& work);

/// Calls work(state, place) for each state of the input until it returns false; place is "file, document 2".
void for_each_state(io::Input& input, const std::function<bool(State, const std::string& place)>& work);

}  // namespace kiln::cli
