// conformance_test.cpp: runs the documents of tests/data/conformance through the reader of states; see the README there.
#include <doctest/doctest.h>

#include <map>
#include <set>
#include <sstream>

#include "io/files.h"
#include "io/state_io.h"
#include "tests/unit/stream_support.h"

namespace {

using namespace kiln;
using namespace kiln::test;

/// The tests are compiled and run in the top folder of the project.
const std::filesystem::path folder = std::filesystem::path(__FILE__).parent_path() / "../data/conformance";

/// Lines of a table by their first column.
std::map<std::string, std::string> table(const std::string& name) {
    std::ifstream file(folder / name);
    std::map<std::string, std::string> rows;
    for (std::string line; std::getline(file, line);)
        if (line[0] != '#') rows[line.substr(0, line.find('\t'))] = line.substr(line.find('\t') + 1);
    return rows;
}

/// Every file must have a line, and every line a file.
void check_complete(const std::map<std::string, std::string>& rows, const std::string& kind) {
    std::set<std::string> files, listed;
    for (const auto& entry : std::filesystem::directory_iterator(folder / kind)) files.insert(entry.path().filename().string());
    for (const auto& row : rows) listed.insert(row.first + ".dem");
    CHECK(files == listed);
}

std::string path_of(const std::string& kind, const std::string& name) { return (folder / kind / (name + ".dem")).string(); }

std::vector<State> states_of(const std::string& path) {
    io::Input input({path});
    std::vector<State> states;
    while (auto state = input.next_state()) states.push_back(std::move(*state));
    return states;
}

/// A state as text, so that two states can be compared.
std::string canonical(const State& state) { return bytes_of(io::document_from(state), true); }

TEST_CASE("every valid document is taken, and is the same after it was written as text and as binary") {
    const auto rows = table("valid.tsv");
    check_complete(rows, "valid");
    REQUIRE(rows.size() > 20);
    for (const auto& [name, verdict] : rows) {
        CAPTURE(name);
        std::istringstream words(verdict);
        std::size_t documents = 0, particles = 0, bonds = 0;
        words >> documents >> particles >> bonds;
        std::vector<State> states;
        REQUIRE(sentence_of([&] { states = states_of(path_of("valid", name)); }) == "");
        REQUIRE(states.size() == documents);
        CHECK(states[0].particles.size() == particles);
        CHECK((states[0].bonds ? states[0].bonds->size() : 0) == bonds);
        const bool text_can_hold_it = name != "binary-nan-in-unknown-array";
        for (const State& state : states) {
            const std::string binary = bytes_of(io::document_from(state), false);
            CHECK(bytes_of(io::document_from(io::state_from(document_of(binary))), false) == binary);
            if (text_can_hold_it) CHECK(canonical(io::state_from(document_of(binary))) == canonical(state));
            if (text_can_hold_it) CHECK(canonical(io::state_from(document_of(canonical(state)))) == canonical(state));
        }
    }
}

TEST_CASE("every invalid document is refused with its sentence") {
    const auto rows = table("invalid.tsv");
    check_complete(rows, "invalid");
    REQUIRE(rows.size() > 90);
    for (const auto& [name, sentence] : rows) {
        CAPTURE(name);
        const std::string path = path_of("invalid", name);
        CHECK(sentence_of([&] { states_of(path); }) == path + sentence);
    }
}

}  // namespace
