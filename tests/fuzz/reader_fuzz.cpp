// reader_fuzz.cpp: libFuzzer target: any bytes are read as a stream; what is taken must be sound and come back the same.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>

#include "io/files.h"
#include "io/state_io.h"
#include "io/write_document.h"

namespace {

using namespace kiln;

using File = std::unique_ptr<std::FILE, decltype(&std::fclose)>;

void require(bool sound, const char* what) {
    if (sound) return;
    std::fprintf(stderr, "not sound: %s\n", what);
    std::abort();
}

/// A stream in memory; to the reader it is a pipe, whose length nobody knows.
File file_of(const std::string& bytes) { return {fmemopen(const_cast<char*>(bytes.data()), bytes.size(), "rb"), &std::fclose}; }

std::string bytes_of(const io::Document& document, bool text) {
    char* data = nullptr;
    std::size_t size = 0;
    File file(open_memstream(&data, &size), &std::fclose);
    std::string failure;
    try {
        io::write_document(file.get(), "copy", document, text);
    } catch (const Error& error) {
        failure = error.what();
    }
    file.reset();
    const std::unique_ptr<char, decltype(&std::free)> owner(data, &std::free);
    if (!failure.empty()) throw Error(failure);
    return {data, size};
}

io::Document document_of(const std::string& bytes) {
    const File file = file_of(bytes);
    io::DocumentReader reader(file.get(), "copy");
    io::Document document;
    require(reader.next(document), "what was written is a document");
    return document;
}

/// What no state may hold.
void check_sound(const State& state) {
    const Particles& particles = state.particles;
    const std::size_t count = particles.size();
    require(particles.id.size() == count && particles.position.size() == count && particles.material.size() == count, "columns");
    require(std::isfinite(state.time) && state.box.origin.allFinite() && state.box.lengths.allFinite(), "finite header");
    require((state.box.lengths.array() > 0.0).all(), "box");
    for (std::size_t row = 0; row < count; ++row) {
        require(particles.position[row].allFinite() && std::isfinite(particles.radius[row]), "finite particle");
        require(particles.radius[row] > 0.0, "radius");
        const std::int32_t material = particles.material[row];
        require(material >= 0 && static_cast<std::size_t>(material) < state.materials.size(), "material");
    }
    if (!state.bonds) return;
    const Bonds& bonds = *state.bonds;
    require(bonds.pair.size() == bonds.size() && bonds.image.size() == bonds.size() && bonds.length.size() == bonds.size() &&
                bonds.volume.size() == bonds.size(),
            "bond columns");
    for (std::size_t bond = 0; bond < bonds.size(); ++bond) {
        require(std::isfinite(bonds.radius[bond] + bonds.length[bond] + bonds.volume[bond]), "finite bond");
        for (const std::int32_t row : bonds.pair[bond]) require(row >= 0 && static_cast<std::size_t>(row) < count, "pair");
    }
}

/// A document that was taken is written and read to the same bytes, in both forms; text may refuse the NaN of an unknown array.
void check_round_trip(const io::Document& document) {
    const std::string binary = bytes_of(document, false);
    require(bytes_of(document_of(binary), false) == binary, "binary copy");
    std::string text;
    try {
        text = bytes_of(document, true);
    } catch (const Error&) {
        return;
    }
    require(bytes_of(document_of(text), false) == binary, "text copy");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string bytes(reinterpret_cast<const char*>(data), size);
    if (bytes.empty()) return 0;  // fmemopen wants at least one
    const File file = file_of(bytes);
    io::DocumentReader reader(file.get(), "input");
    try {
        for (io::Document document; reader.next(document);) {
            check_round_trip(document);
            const State state = io::state_from(std::move(document));
            check_sound(state);
            check_round_trip(io::document_from(state));
        }
    } catch (const Error& error) {
        require(std::string(error.what()).size() < 600, "a sentence, not a page");
    }
    return 0;
}
