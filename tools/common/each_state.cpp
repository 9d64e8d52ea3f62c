// each_state.cpp: documents and states of a run's input, one after the other.
#include "tools/common/each_state.h"

#include <cstdio>
#include <cstdlib>
#include <memory>

#include "io/state_io.h"
#include "io/write_document.h"
#include "tools/common/ranks.h"

namespace kiln::cli {

namespace {

struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
};

using Memory = std::unique_ptr<std::FILE, Close>;

std::string bytes_of(const io::Document& document) {
    char* bytes = nullptr;
    std::size_t size = 0;
    {
        const Memory file(open_memstream(&bytes, &size));
        io::write_document(file.get(), document.place, document, false);
    }
    const std::unique_ptr<char, decltype(&std::free)> owned(bytes, std::free);
    return {bytes, size};
}

io::Document document_of(std::string bytes, const std::string& place) {
    const Memory file(fmemopen(bytes.data(), bytes.size(), "rb"));
    io::Document document;
    io::DocumentReader(file.get(), place).next(document);
    document.place = place;
    return document;
}

/// What the first process reads goes to the others as a place and bytes: both empty at the end, no place where it failed.
std::optional<io::Document> read_for_all(io::Input& input) {
    std::string place, bytes;
    std::optional<io::Document> document;
    const auto share = [&] {
        ranks::broadcast(place);
        ranks::broadcast(bytes);
    };
    try {
        document = input.next();
        if (document) {
            bytes = bytes_of(*document);
            place = document->place;
        }
    } catch (...) {
        bytes = "failed";
        share();
        throw;
    }
    share();
    return document;
}

std::optional<io::Document> hear() {
    std::string place, bytes;
    ranks::broadcast(place);
    ranks::broadcast(bytes);
    if (bytes.empty()) return std::nullopt;
    if (place.empty()) throw Interrupted();
    return document_of(std::move(bytes), place);
}

}  // namespace

std::optional<io::Document> next_document(io::Input& input) {
    if (ranks::count() == 1) return input.next();
    return ranks::rank() == 0 ? read_for_all(input) : hear();
}

void for_each_document(io::Input& input, const std::function<void(io::Document)>& work) {
    while (auto document = next_document(input)) {
        const std::string place = document->place;
        at_place(place, [&] { work(std::move(*document)); });
    }
}

void for_each_state(io::Input& input, const std::function<bool(State, const std::string& place)>& work) {
    while (auto document = next_document(input)) {
        const std::string place = document->place;
        State state = io::state_from(std::move(*document));
        if (!at_place(place, [&] { return work(std::move(state), place); })) return;
    }
}

}  // namespace kiln::cli
