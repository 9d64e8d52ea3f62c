// each_state.cpp: documents and states of a run's input, one after the other.
#include "tools/common/each_state.h"

#include "io/state_io.h"

namespace kiln::cli {

void for_each_document(io::Input& input, const std::function<void(io::Document)>& work) {
    while (auto document = input.next()) {
        const std::string place = document->place;
        at_place(place, [&] { work(std::move(*document)); });
    }
}

void for_each_state(io::Input& input, const std::function<bool(State, const std::string& place)>& work) {
    while (auto document = input.next()) {
        const std::string place = document->place;
        State state = io::state_from(std::move(*document));
        if (!at_place(place, [&] { return work(std::move(state), place); })) return;
    }
}

}  // namespace kiln::cli
