// checkpoint_test.cpp: a checkpoint comes back whole, is refused where it is not this run's, and is never lost for a newer one.
#include <doctest/doctest.h>

#include <chrono>
#include <limits>

#include "io/checkpoint.h"
#include "tests/unit/stream_support.h"

namespace {

using namespace kiln;
using namespace kiln::test;

const Json arguments_of_run = {"--temperature", "1200C", "--to-density", "0.7"};

/// Two spheres in working order, with an array of the method and a key that somebody else put into the document.
State two_spheres_under_way() {
    State state;
    state.time = 12.5;
    state.temperature = 1473.15;
    state.box.lengths = Vec3(1e-6, 2e-6, 3e-6);
    state.particles.id = {7, 3};
    state.particles.position = {Vec3(0.1e-6, 0.2e-6, 0.3e-6), Vec3(0.2e-6, 0.2e-6, 1.0 / 3.0 * 1e-6)};
    state.particles.radius = {0.05e-6, 0.07e-6};
    state.particles.material = {0, 0};
    state.particles.other = {{"velocity", {{2, 3}, std::vector<double>{1e-9, -2e-9, 0.0, 1.0 / 7.0, 5e-324, -0.0}}}};
    state.materials.resize(1);
    state.materials[0].name = "alumina";
    state.other = R"({"operator":"A. N. Other"})";
    return state;
}

io::Checkpoint under_way() {
    return {.state = two_spheres_under_way(),
            .numbers = {{"step", {1.0 / 3.0}}, {"strain", {-0.01, -0.02, 1e-300}}},
            .run = {.document = 2,
                    .fingerprint = io::fingerprint(two_spheres_under_way()),
                    .output_bytes = 5'000'000'000,  // more than 32 bits hold
                    .history_bytes = 77,
                    .newton = 31,
                    .conjugate_gradients = 415,
                    .converged = false,
                    .finished = true}};
}

io::CheckpointFile file_to_resume(const std::string& name, const Json& arguments = arguments_of_run) {
    return {name, true, 60.0, arguments};
}

/// The bytes of a checkpoint whose own key is as change() makes it.
void put_changed(const std::string& name, const std::function<void(Json& header)>& change) {
    file_to_resume(name).write(under_way());
    io::Document document = document_of(contents_of(name));
    change(document.header);
    std::ofstream(name, std::ios::binary) << bytes_of(document, false);
}

std::string refusal(const std::string& name) {
    return sentence_of([&] { file_to_resume(name).read(); });
}

TEST_CASE("a checkpoint comes back whole, to the last bit") {
    const Folder folder;
    io::CheckpointFile file = file_to_resume(folder / "run");
    CHECK_FALSE(file.read());
    file.write(under_way());
    const std::optional<io::Checkpoint> back = file_to_resume(folder / "run").read();
    REQUIRE(back);
    const io::Checkpoint wanted = under_way();
    CHECK(back->numbers == wanted.numbers);
    CHECK(back->state.time == wanted.state.time);
    CHECK(back->state.temperature == wanted.state.temperature);
    CHECK(back->state.box.lengths == wanted.state.box.lengths);
    CHECK(back->state.particles.id == wanted.state.particles.id);
    CHECK(back->state.particles.position == wanted.state.particles.position);
    CHECK(back->state.particles.radius == wanted.state.particles.radius);
    REQUIRE(back->state.particles.other.size() == 1);
    CHECK(back->state.particles.other[0].name == "velocity");
    CHECK(back->state.particles.other[0].array.shape == wanted.state.particles.other[0].array.shape);
    CHECK(back->state.particles.other[0].array.data == wanted.state.particles.other[0].array.data);
    CHECK(Json::parse(back->state.other)["operator"] == "A. N. Other");
    CHECK(back->run.document == 2);
    CHECK(back->run.fingerprint == wanted.run.fingerprint);
    CHECK(back->run.output_bytes == 5'000'000'000);
    CHECK(back->run.history_bytes == 77);
    CHECK(back->run.newton == 31);
    CHECK(back->run.conjugate_gradients == 415);
    CHECK_FALSE(back->run.converged);
    CHECK(back->run.finished);
    // What was read is written as the same bytes: a run that is broken off twice has lost nothing in between.
    file_to_resume(folder / "again").write(*back);
    CHECK(contents_of(folder / "again") == contents_of(folder / "run"));
}

TEST_CASE("a checkpoint is read only where the run is to be resumed") {
    const Folder folder;
    file_to_resume(folder / "run").write(under_way());
    CHECK_FALSE(io::CheckpointFile(folder / "run", false, 60.0, arguments_of_run).read());
}

TEST_CASE("a checkpoint of other options or another input is refused in a sentence that says which") {
    const Folder folder;
    file_to_resume(folder / "run").write(under_way());
    CHECK(sentence_of([&] { file_to_resume(folder / "run", {"--temperature", "1300C"}).read(); }) ==
          folder / "run: is of a run with other options, " + arguments_of_run.dump() + "; delete it to begin anew");
    CHECK(arguments_of_run.dump() == R"(["--temperature","1200C","--to-density","0.7"])");
    const io::Checkpoint found = *file_to_resume(folder / "run").read();
    CHECK(sentence_of([&] { found.require_input(io::fingerprint(two_spheres_under_way())); }) == "");
    State other = two_spheres_under_way();
    other.particles.radius[1] *= 1.0 + 1e-15;
    CHECK(sentence_of([&] { found.require_input(io::fingerprint(other)); }) == "the checkpoint is of another input");
}

TEST_CASE("the fingerprint tells positions, radii and boxes from each other, and nothing else") {
    const std::string wanted = io::fingerprint(two_spheres_under_way());
    CHECK(wanted.size() == 16);
    const auto changed = [&](const std::function<void(State&)>& change) {
        State state = two_spheres_under_way();
        change(state);
        return io::fingerprint(state) != wanted;
    };
    CHECK(changed([](State& state) { state.particles.position[1][2] = 0.0; }));
    CHECK(changed([](State& state) { std::swap(state.particles.position[0], state.particles.position[1]); }));
    CHECK(changed([](State& state) { std::swap(state.particles.radius[0], state.particles.radius[1]); }));
    CHECK(changed([](State& state) { state.box.lengths[0] = 2e-6; }));
    CHECK_FALSE(changed([](State& state) { state.history = R"([{"tool":"bondify"}])"; }));
    // FNV-1a of no bytes but three ones of the box: from the definition, with the constants of Fowler, Noll & Vo.
    std::uint64_t hash = 14695981039346656037ULL;
    for (int axis = 0; axis < 3; ++axis)
        for (const unsigned byte : {0x00U, 0x00U, 0x00U, 0x00U, 0x00U, 0x00U, 0xf0U, 0x3fU})
            hash = (hash ^ byte) * 1099511628211ULL;
    char text[17];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
    CHECK(io::fingerprint(State()) == text);
}

TEST_CASE("a checkpoint that was cut off anywhere is refused in a sentence that names it") {
    const Folder folder;
    file_to_resume(folder / "run").write(under_way());
    const std::string whole = contents_of(folder / "run");
    for (std::size_t bytes = 0; bytes < whole.size(); ++bytes) {
        CAPTURE(bytes);
        std::ofstream(folder / "run", std::ios::binary) << whole.substr(0, bytes);
        CHECK(refusal(folder / "run").starts_with(folder / "run"));
    }
}

TEST_CASE("what is no checkpoint is refused: other documents, other bytes, keys that are missing or of another kind") {
    const Folder folder;
    const std::string name = folder / "run", none = name + ": is no checkpoint of sinter";
    std::ofstream(name) << "half a checkpoint";
    CHECK(refusal(name) == name + ", document 1: begins with byte 104, expected '{', the beginning of a JSON object");
    for (const char* key : {"checkpoint", "sintering"}) {
        put_changed(name, [&](Json& header) { header.erase(key); });
        CHECK(refusal(name) == none);
    }
    put_changed(name, [](Json& header) { header["checkpoint"] = "here"; });
    CHECK(refusal(name).starts_with(none + ": "));
    put_changed(name, [](Json& header) { header["sintering"]["step"] = "long"; });
    CHECK(refusal(name).starts_with(none + ": "));
    for (const char* key : {"document", "fingerprint", "arguments", "output_bytes", "history_bytes", "newton",
                            "conjugate_gradients", "converged", "finished"}) {
        CAPTURE(key);
        put_changed(name, [&](Json& header) { header["checkpoint"].erase(key); });
        CHECK(refusal(name).starts_with(none + ": "));
        if (std::string(key) == "arguments") continue;
        put_changed(name, [&](Json& header) { header["checkpoint"][key] = nullptr; });
        CHECK(refusal(name).starts_with(none + ": "));
    }
    put_changed(name, [](Json&) {});
    CHECK(refusal(name) == "");
}

TEST_CASE("a checkpoint is due when the interval has passed since the last one") {
    using std::chrono::seconds;
    const Folder folder;
    const auto before = io::CheckpointFile::Clock::now();
    io::CheckpointFile file(folder / "run", false, 60.0, arguments_of_run);
    const auto first = io::CheckpointFile::Clock::now() + seconds(60);
    CHECK_FALSE(file.due(before));
    CHECK_FALSE(file.due(before + seconds(59)));
    CHECK(file.due(first));
    file.write(under_way());
    CHECK_FALSE(file.due(first));
    CHECK(file.due(io::CheckpointFile::Clock::now() + seconds(60)));
    CHECK(io::CheckpointFile(folder / "run", false, 0.0, arguments_of_run).due());
    CHECK_FALSE(io::CheckpointFile("", false, 0.0, arguments_of_run).due());
}

TEST_CASE("a checkpoint that cannot be written leaves the one before as it was") {
    const Folder folder;
    io::CheckpointFile file = file_to_resume(folder / "run");
    file.write(under_way());
    const std::string before = contents_of(folder / "run");
    io::Checkpoint later = under_way();
    later.numbers["step"] = {std::numeric_limits<double>::quiet_NaN()};
    CHECK(sentence_of([&] { file.write(later); }) == folder / "run.step.0 is not a finite number");
    CHECK(contents_of(folder / "run") == before);
    later = under_way();
    later.state.particles.position[1][0] = std::numeric_limits<double>::infinity();
    CHECK(sentence_of([&] { file.write(later); }).find("position") != std::string::npos);
    CHECK(contents_of(folder / "run") == before);
    CHECK(folder.size() == 1);
    std::filesystem::create_directory(folder / "run.partial");
    CHECK(sentence_of([&] { file.write(under_way()); }).starts_with(folder / "run: cannot be written"));
    CHECK(contents_of(folder / "run") == before);
}

TEST_CASE("the checkpoint before stays whole until the new one has its name, over what an interruption left") {
    const Folder folder;
    io::CheckpointFile file = file_to_resume(folder / "run");
    file.write(under_way());
    const std::string before = contents_of(folder / "run");
    std::filesystem::create_hard_link(folder / "run", folder / "before");  // it would change with a file that is written over
    std::ofstream(folder / "run.partial") << std::string(2 * before.size(), 'x');
    io::Checkpoint later = under_way();
    later.run.newton = 32;
    file.write(later);
    CHECK(contents_of(folder / "before") == before);
    CHECK(file.read()->run.newton == 32);
    CHECK(contents_of(folder / "run").size() == before.size());
    CHECK_FALSE(std::filesystem::exists(folder / "run.partial"));
}

TEST_CASE("removal takes the checkpoint away, and nothing else") {
    const Folder folder;
    io::CheckpointFile file = file_to_resume(folder / "run");
    file.write(under_way());
    std::ofstream(folder / "other") << "x";
    io::CheckpointFile("", true, 0.0, arguments_of_run).remove();
    CHECK(folder.size() == 2);
    file.remove();
    CHECK(folder.size() == 1);
    CHECK_FALSE(file.read());
    file.remove();  // of a run so short that it never wrote one
    CHECK(folder.size() == 1);
}

}  // namespace
