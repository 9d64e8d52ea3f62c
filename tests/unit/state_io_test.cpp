// state_io_test.cpp: states through documents: defaults, what passes untouched, and the rules about names and values.
#include <doctest/doctest.h>

#include <limits>
#include <numbers>

#include "io/state_io.h"
#include "tests/physics/relative.h"
#include "tests/unit/stream_support.h"
#include "io/material_io.h"
#include "io/json_values.h"

namespace {

using namespace kiln;
using namespace kiln::test;

constexpr const char* two_spheres =
    R"({"box":{"vectors":[[3,0,0],[0,4,0],[0,0,5]]},"particles":{"position":{"type":"f8","shape":[2,3],"data":[0,0,0,1.5,0,0]},)"
    R"("radius":{"type":"f8","shape":[2],"data":[1,0.5]}}})";

State state_of(const std::string& line) { return io::state_from(document_of(line + "\n")); }

/// A state with everything that a state can have.
State rich_state() {
    State state = state_of(two_spheres);
    state.time = 12.5;
    state.temperature = 1473.15;
    state.box.origin = {-1.0, 1.0 / 3.0, 0.0};
    state.box.periodic = {true, false, true};
    state.materials.push_back({});
    state.materials[1].name = "zirconia";
    state.materials[1].poisson_ratio = -0.25;
    state.materials[1].other = R"({"colour":"white","grain_boundary_diffusion":{"source":"a paper"}})";
    state.materials[1].diffusion_prefactor = 1e-8;
    state.materials[1].activation_energy = 4e5;
    state.contacts.push_back({{1, 0}, 0.7, 3e-40});
    state.particles.id = {70, -5};
    state.particles.material = {1, 0};
    state.particles.other = {{"velocity", {{2, 3}, std::vector<float>{1, 2, 3, 4, 5, 6}}},
                             {"a", {{2}, std::vector<std::uint8_t>{7, 8}}}};
    state.bonds = Bonds{{{{0, 1}}, {{1, 1}}}, {{{0, -1, 127}}, {{1, 0, 0}}}, {0.1, 0.0}, {1.5, -0.25}, {0.5, 0.0}, {}};
    state.bonds->other = {{"force", {{2, 1}, std::vector<double>{1e-9, -0.0}}}};
    state.necks = Necks{{{{1, 0}}, {{1, 1}}}, {{{0, -1, 5}}, {{1, 0, 0}}}, {0.25, 0.0}, {}};
    state.necks->other = {{"age", {{2}, std::vector<std::int32_t>{3, 4}}}};
    state.materials[1].surface_prefactor = 3e-11;
    state.materials[1].surface_activation = 3e5;
    state.materials[1].mobility_prefactor = 0.01;
    state.materials[1].mobility_activation = 4.4e5;
    state.history = R"([{"tool":"x","summary":{"b":1,"a":2}}])";
    state.other = R"({"box":{"comment":"wet"},"contacts":[{"note":[1]}],"zoo":1,"ark":{"b":null,"a":1}})";
    return state;
}

void check_same(const State& a, const State& b) {
    CHECK(a.time == b.time);
    CHECK(a.temperature == b.temperature);
    CHECK(a.box.origin == b.box.origin);
    CHECK(a.box.lengths == b.box.lengths);
    CHECK(a.box.periodic == b.box.periodic);
    REQUIRE(a.materials.size() == b.materials.size());
    for (std::size_t row = 0; row < a.materials.size(); ++row)
        CHECK(io::material_json(a.materials[row]).dump() == io::material_json(b.materials[row]).dump());
    REQUIRE(a.contacts.size() == b.contacts.size());
    for (std::size_t row = 0; row < a.contacts.size(); ++row) {
        CHECK(a.contacts[row].materials == b.contacts[row].materials);
        CHECK(a.contacts[row].surface_energy == b.contacts[row].surface_energy);
        CHECK(a.contacts[row].diffusion_parameter == b.contacts[row].diffusion_parameter);
    }
    CHECK(a.particles.id == b.particles.id);
    CHECK(a.particles.position == b.particles.position);
    CHECK(a.particles.radius == b.particles.radius);
    CHECK(a.particles.material == b.particles.material);
    REQUIRE(a.bonds.has_value() == b.bonds.has_value());
    if (a.bonds) {
        CHECK(a.bonds->pair == b.bonds->pair);
        CHECK(a.bonds->image == b.bonds->image);
        CHECK(a.bonds->radius == b.bonds->radius);
        CHECK(a.bonds->length == b.bonds->length);
        CHECK(a.bonds->volume == b.bonds->volume);
        CHECK(a.bonds->other.size() == b.bonds->other.size());
    }
    REQUIRE(a.necks.has_value() == b.necks.has_value());
    if (a.necks) {
        CHECK(a.necks->pair == b.necks->pair);
        CHECK(a.necks->image == b.necks->image);
        CHECK(a.necks->radius == b.necks->radius);
        CHECK(a.necks->other.size() == b.necks->other.size());
    }
    CHECK(a.history == b.history);
    CHECK(a.other == b.other);
}

TEST_CASE("box, positions and radii are enough; the rest has defaults") {
    const State state = state_of(two_spheres);
    CHECK(state.time == 0.0);
    CHECK_FALSE(state.temperature);
    CHECK(state.box.origin == Vec3::Zero());
    CHECK(state.box.lengths == Vec3(3, 4, 5));
    CHECK(state.box.periodic == std::array{true, true, true});
    REQUIRE(state.materials.size() == 1);
    CHECK(state.materials[0].name == "alumina");
    CHECK(state.materials[0].young_modulus == 400e9);
    CHECK(state.particles.id == std::vector<std::int64_t>{0, 1});
    CHECK(state.particles.position == std::vector<Vec3>{{0, 0, 0}, {1.5, 0, 0}});
    CHECK(state.particles.radius == std::vector<double>{1, 0.5});
    CHECK(state.particles.material == std::vector<std::int32_t>{0, 0});
    CHECK_FALSE(state.bonds);
    CHECK(state.history == "[]");
    CHECK(state.other == "{}");
}

TEST_CASE("bonds without images and volumes join particles of the box itself and have the volume of their cylinder") {
    std::string line = two_spheres;
    line.pop_back();
    line += R"(,"bonds":{"pair":{"type":"i4","shape":[1,2],"data":[0,1]},"radius":{"type":"f8","shape":[1],"data":[0.5]},)"
            R"("length":{"type":"f8","shape":[1],"data":[1.5]}}})";
    const State state = state_of(line);
    REQUIRE(state.bonds);
    CHECK(state.bonds->image == std::vector<Image>{{0, 0, 0}});
    CHECK(state.bonds->volume.at(0) == relative(std::numbers::pi * 0.375, 1e-15));
}

TEST_CASE("a state comes back whole, and writing it again gives the same bytes") {
    for (const bool text : {true, false}) {
        CAPTURE(text);
        const std::string bytes = bytes_of(io::document_from(rich_state()), text);
        const State back = io::state_from(document_of(bytes));
        check_same(back, rich_state());
        CHECK(bytes_of(io::document_from(back), text) == bytes);
    }
}

TEST_CASE("necks of a record: images are optional, and what is none is refused with its row") {
    const std::string spheres = two_spheres;
    const auto with = [&](const std::string& necks) {
        return spheres.substr(0, spheres.size() - 1) + R"(,"necks":)" + necks + "}";
    };
    const auto necks = [&](const std::string& pairs, const std::string& radii, std::size_t count) {
        const std::string rows = std::to_string(count);
        return with(R"({"pair":{"type":"i4","shape":[)" + rows + R"(,2],"data":)" + pairs +
                    R"(},"radius":{"type":"f8","shape":[)" + rows + R"(],"data":)" + radii + "}}");
    };
    const State state = state_of(necks("[0,1]", "[0.125]", 1));
    REQUIRE(state.necks);
    CHECK(state.necks->radius == std::vector{0.125});
    CHECK(state.necks->image == std::vector{Image{0, 0, 0}});
    const auto refusal = [&](const std::string& line) { return sentence_of([&] { state_of(line); }); };
    CHECK(refusal(necks("[0,2]", "[0.1]", 1)).ends_with("neck 0 has particle row 2, there are 2"));
    CHECK(refusal(necks("[1,1]", "[0.1]", 1)).ends_with("neck 0 has particle row 1 at both ends"));
    CHECK(refusal(necks("[0,1]", "[-0.1]", 1)).ends_with("neck 0 has radius -0.1, expected none below zero"));
    CHECK(refusal(necks("[0,1,1,0]", "[0.1,0.2]", 2))
              .ends_with("necks 0 and 1 are one: both join particle rows 0 and 1 with the same image"));
    CHECK(refusal(with("3")).ends_with("necks is not an object of arrays"));
    CHECK(refusal(with(R"({"pair":{"type":"i4","shape":[0,2],"data":[]}})")).ends_with("necks need the arrays pair and radius"));
}

TEST_CASE("a state without particles and one with an empty bond list come back") {
    State state = rich_state();
    state.particles = {};
    state.bonds = Bonds{};
    state.necks = Necks{};
    for (const bool text : {true, false}) {
        const State back = io::state_from(document_of(bytes_of(io::document_from(state), text)));
        CHECK(back.particles.size() == 0);
        REQUIRE(back.bonds);
        CHECK(back.bonds->size() == 0);
        REQUIRE(back.necks);
        CHECK(back.necks->size() == 0);
    }
}

TEST_CASE("unknown keys and arrays pass in their order: of the document, its box, its materials and its contacts") {
    const Json written = io::document_from(rich_state()).header;
    CHECK(written["box"]["comment"] == "wet");
    CHECK(written["contacts"][0]["note"] == Json::parse("[1]"));
    CHECK(written["contacts"][0]["materials"] == Json::parse(R"(["zirconia","alumina"])"));
    CHECK(written["materials"][1]["colour"] == "white");
    CHECK(written["materials"][1]["grain_boundary_diffusion"].dump() ==
          R"({"prefactor":1e-08,"activation_energy":400000.0,"source":"a paper"})");
    CHECK(written["ark"].dump() == R"({"b":null,"a":1})");
    CHECK(written.dump().find("\"zoo\"") < written.dump().find("\"ark\""));
    const io::Document document = io::document_from(rich_state());
    std::string names;
    for (const auto* group : {&document.particles, &document.bonds})
        for (const NamedArray& named : *group) names += named.name + " ";
    CHECK(names == "id position radius material velocity a pair image radius length volume force ");
}

TEST_CASE("nothing is carried of a document whose keys are all known") {
    State state = rich_state();
    state.other = "{}";
    CHECK(io::state_from(document_of(bytes_of(io::document_from(state), true))).other == "{}");
}

TEST_CASE("what a tool knows is stronger than what it carries") {
    Json target = Json::parse(R"({"a":1,"b":{"c":2},"d":[{"e":3},{}],"f":[1]})");
    io::put_back(target, Json::parse(R"({"a":9,"b":{"c":9,"g":4},"d":[{"e":9,"h":5},{"i":6}],"f":[9,9],"j":7})"));
    CHECK(target.dump() == R"({"a":1,"b":{"c":2,"g":4},"d":[{"e":3,"h":5},{"i":6}],"f":[1],"j":7})");
}

TEST_CASE("a calculation that ends in NaN does not get into a stream") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const auto refusal = [](const State& state) { return sentence_of([&] { bytes_of(io::document_from(state), false); }); };
    CHECK(refusal(rich_state()).empty());
    State state = rich_state();
    state.particles.position[1][2] = -std::numeric_limits<double>::infinity();
    CHECK(refusal(state) == "the state to be written: particles.position, row 1: is not a finite number");
    state = rich_state();
    state.particles.radius[0] = nan;
    CHECK(refusal(state) == "the state to be written: particles.radius, row 0: is not a finite number");
    state = rich_state();
    state.bonds->length[1] = nan;
    CHECK(refusal(state) == "the state to be written: bonds.length, row 1: is not a finite number");
    state = rich_state();
    state.time = nan;
    CHECK(refusal(state) == "stream: time is not a finite number");
    state = rich_state();
    state.box.lengths[2] = nan;
    CHECK(refusal(state) == "stream: box.vectors.2.2 is not a finite number");
}

TEST_CASE("NaN and infinity in binary arrays are refused with their row") {
    const State good = rich_state();
    const double values[] = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::signaling_NaN(),
                             std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (const double bad : values) {
        for (const char* name : {"position", "radius"}) {
            io::Document document = io::document_from(good);
            document.place = "stream, document 1";
            for (NamedArray& named : document.particles)
                if (named.name == name) std::get<std::vector<double>>(named.array.data).back() = bad;
            CHECK(sentence_of([&] { io::state_from(document); }) ==
                  "stream, document 1: particles." + std::string(name) + ", row 1: is not a finite number");
        }
        for (const char* name : {"radius", "length", "volume"}) {
            io::Document document = io::document_from(good);
            document.place = "stream, document 1";
            for (NamedArray& named : document.bonds)
                if (named.name == name) std::get<std::vector<double>>(named.array.data).front() = bad;
            CHECK(sentence_of([&] { io::state_from(document); }) ==
                  "stream, document 1: bonds." + std::string(name) + ", row 0: is not a finite number");
        }
    }
}

TEST_CASE("numbers of a header are finite and within their range") {
    CHECK(io::number_from(Json(2.5), "x", 0.0) == 2.5);
    CHECK(io::number_from(Json(-1), "x", -1.0) == -1.0);
    CHECK(sentence_of([] { io::number_from(Json(-1.5), "x", 0.0); }) == "x is -1.5, below 0.0");
    CHECK(sentence_of([] { io::number_from(Json("1"), "x", 0.0); }) == "x is \"1\", not a number");
    CHECK(sentence_of([] { io::number_from(Json(INFINITY), "x", 0.0); }) == "x is null, not a number");
}

}  // namespace
