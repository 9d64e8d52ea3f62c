// document_test.cpp: what is written comes back, text and binary, bit by bit and in order, each array at a multiple of 64 bytes.
#include <doctest/doctest.h>

#include <bit>
#include <limits>
#include <random>

#include "tests/unit/stream_support.h"

namespace {

using namespace kiln;
using namespace kiln::test;

template <typename Value>
NamedArray array(const std::string& name, std::vector<std::size_t> shape, std::vector<Value> values) {
    return {name, {std::move(shape), std::move(values)}};
}

template <typename Value>
std::vector<Value> extremes() {
    using Limits = std::numeric_limits<Value>;
    return {Limits::min(), Limits::max(), Limits::lowest(), Value{0}, Value{1}, static_cast<Value>(77)};
}

/// All seven types, an empty array, a column without rows, keys and arrays that nobody knows.
io::Document rich_document() {
    io::Document document;
    document.header = Json::parse(
        R"({"format":"other","zebra":null,"apple":[1,{"b":[],"a":{}}],"text":"\u00e9 \u0000 \ud83d\ude00","time":1e-300})");
    document.particles = {
        array("zeta", {2, 3}, std::vector<double>{0.1, -0.0, 5e-324, 1.7976931348623157e308, 1.0 / 3.0, 2.2250738585072014e-308}),
        array("single", {6}, extremes<float>()),
        array("long", {3, 2}, extremes<std::int64_t>()),
        array("int", {6}, extremes<std::int32_t>()),
        array("short", {6, 1, 1}, extremes<std::int16_t>()),
        array("char", {6}, extremes<std::int8_t>()),
        array("byte", {6}, extremes<std::uint8_t>()),
        array("empty", {0, 3}, std::vector<double>{}),
        array("alpha", {4, 0}, std::vector<std::int16_t>{}),
    };
    document.bonds = {array("only", {1}, std::vector<float>{0.1f})};
    document.has_bonds = true;
    return document;
}

/// Equal bits; == would take -0 for 0.
bool same_bits(const Array& a, const Array& b) {
    if (a.shape != b.shape || a.data.index() != b.data.index()) return false;
    return std::visit(
        [&](const auto& values) {
            const auto& others = std::get<std::decay_t<decltype(values)>>(b.data);
            return values.size() == others.size() &&
                   (values.empty() || std::memcmp(values.data(), others.data(), values.size() * sizeof(values[0])) == 0);
        },
        a.data);
}

void check_same(const std::vector<NamedArray>& a, const std::vector<NamedArray>& b) {
    REQUIRE(a.size() == b.size());
    for (std::size_t index = 0; index < a.size(); ++index) {
        CAPTURE(a[index].name);
        CHECK(a[index].name == b[index].name);
        CHECK(same_bits(a[index].array, b[index].array));
    }
}

void check_same(const io::Document& a, const io::Document& b) {
    CHECK(a.header.dump() == b.header.dump());  // as text: the order of keys counts
    check_same(a.particles, b.particles);
    CHECK(a.has_bonds == b.has_bonds);
    check_same(a.bonds, b.bonds);
}

TEST_CASE("a document comes back from text and binary, file and pipe, as it was") {
    const io::Document document = rich_document();
    for (const bool text : {true, false}) {
        CAPTURE(text);
        const std::string bytes = bytes_of(document, text);
        check_same(document_of(bytes), document);
        PipeOf pipe(bytes);
        check_same(documents_of(pipe.get()).at(0), document);
        CHECK(bytes_of(document_of(bytes), text) == bytes);
    }
}

TEST_CASE("a text document is one line, and a binary one starts with a line of JSON padded with blanks") {
    const std::string text = bytes_of(rich_document(), true);
    CHECK(text.find('\n') == text.size() - 1);
    const std::string binary = bytes_of(rich_document(), false);
    const std::size_t end = binary.find('\n');
    CHECK((end + 1) % 64 == 0);
    const Json header = Json::parse(binary.substr(0, end));
    CHECK(header["bytes"] == binary.size() - end - 1);
    CHECK(header["particles"]["zeta"].dump() == R"({"type":"f8","shape":[2,3],"at":0})");
}

TEST_CASE("every array of a binary stream begins at a multiple of 64 bytes of the file, also in documents after the first") {
    std::string stream;
    io::Document lone;
    lone.particles = {array("none", {0}, std::vector<double>{})};
    for (int repeat = 0; repeat < 3; ++repeat) {
        stream += bytes_of(lone, false) + bytes_of(rich_document(), false);
    }
    std::size_t position = 0, arrays = 0;
    while (position < stream.size()) {
        const std::size_t payload = stream.find('\n', position) + 1;
        const Json header = Json::parse(stream.substr(position, payload - position));
        for (const char* group : {"particles", "bonds"})
            for (const Json& spec : header.value(group, Json::object())) {
                CHECK((payload + spec["at"].get<std::size_t>()) % 64 == 0);
                ++arrays;
            }
        position = payload + header["bytes"].get<std::size_t>();
    }
    CHECK(position == stream.size());
    CHECK(arrays == 3 * 11);
}

TEST_CASE("text and binary documents follow each other in one stream") {
    const io::Document document = rich_document();
    const std::string text = bytes_of(document, true), binary = bytes_of(document, false);
    for (const bool through_pipe : {false, true}) {
        CAPTURE(through_pipe);
        const std::string stream = text + binary + "\n \r\n" + binary + text + R"({"plain":1})";
        std::vector<io::Document> documents;
        if (through_pipe) {
            PipeOf pipe(stream);
            documents = documents_of(pipe.get());
        } else {
            documents = documents_of(stream);
        }
        REQUIRE(documents.size() == 5);
        for (std::size_t index = 0; index < 4; ++index) check_same(documents[index], document);
        CHECK(documents[4].header.dump() == R"({"plain":1})");
        CHECK(documents[3].place == "stream, document 4");
    }
}

TEST_CASE("one document holds text arrays beside binary ones, in any order and with gaps between them") {
    std::string payload(32, 'x');
    const double pi = 3.14159;
    const std::int16_t small = -7;
    std::memcpy(payload.data() + 16, &pi, sizeof pi);
    std::memcpy(payload.data() + 3, &small, sizeof small);
    const io::Document document = document_of(
        R"({"particles":{"late":{"type":"f8","shape":[1],"at":16},"text":{"type":"i1","shape":[1,2],"data":[-128,127]},)"
        R"("early":{"type":"i2","shape":[1],"at":3}},"bytes":32})"
        "\n" + payload);
    check_same(document.particles, {array("late", {1}, std::vector<double>{pi}),
                                    array("text", {1, 2}, std::vector<std::int8_t>{-128, 127}),
                                    array("early", {1}, std::vector<std::int16_t>{small})});
}

TEST_CASE("text holds every double and every float exactly") {
    std::mt19937_64 random(3);
    std::vector<double> doubles;
    std::vector<float> floats;
    while (doubles.size() < 20000) {
        const std::uint64_t bits = random();
        if (const double value = std::bit_cast<double>(bits); std::isfinite(value)) doubles.push_back(value);
        const float single = std::bit_cast<float>(static_cast<std::uint32_t>(bits));
        if (std::isfinite(single)) floats.push_back(single);
    }
    io::Document document;
    document.header = Json::object();
    document.particles = {array("f8", {doubles.size()}, doubles), array("f4", {floats.size()}, floats)};
    check_same(document_of(bytes_of(document, true)).particles, document.particles);
}

TEST_CASE("a large array comes back through a pipe, whose length nobody knows") {
    std::vector<double> values(1 << 19);
    for (std::size_t index = 0; index < values.size(); ++index) values[index] = 0.1 * static_cast<double>(index);
    io::Document document;
    document.header = Json::object();
    document.particles = {array("values", {values.size() / 2, 2}, values), array("behind", {1}, std::vector<float>{2.5f})};
    PipeOf pipe(bytes_of(document, false));
    check_same(documents_of(pipe.get()).at(0).particles, document.particles);
}

TEST_CASE("particles or bonds that are plain numbers stay in the header of a result") {
    const std::string line = R"({"relative_density":0.5,"particles":6000,"bonds":null})";
    const io::Document document = document_of(line + "\n");
    CHECK(document.header.dump() == line);
    CHECK_FALSE(document.has_bonds);
    CHECK(bytes_of(document, false) == line + "\n");
}

TEST_CASE("what would make a stream that nobody can read is not written") {
    const auto refusal = [](const io::Document& document, bool text) { return sentence_of([&] { bytes_of(document, text); }); };
    const double nan = std::numeric_limits<double>::quiet_NaN();
    io::Document document;
    document.header = {{"a", {{"b", {1.0, nan}}}}};
    CHECK(refusal(document, false) == "stream: a.b.1 is not a finite number");
    document.header = {{"bytes", 5}};
    CHECK(refusal(document, true) == "stream: the keys particles, bonds, necks and bytes of a document belong to its arrays");
    document.header = {{"bonds", Json::object()}};
    CHECK(refusal(document, true) == "stream: the keys particles, bonds, necks and bytes of a document belong to its arrays");
    document.header = Json::object();
    document.particles = {array("stress", {3}, std::vector<float>{1.0f, 2.0f, -INFINITY})};
    CHECK(refusal(document, true) == "stream: particles.stress: value 2 is not finite and text cannot hold it");
    CHECK(refusal(document, false).empty());
    document.particles.push_back(document.particles[0]);
    CHECK(refusal(document, false) == "stream: particles.stress stands twice");
    document.particles = {array("stress", {3, 2}, std::vector<float>(5))};
    CHECK(refusal(document, false) == "stream: particles.stress has 5 values where its shape requires 6");
}

TEST_CASE("names that are no UTF-8, such as those of files, do not stop the writer") {
    io::Document document;
    document.header = {{"arguments", {"caf\xe9"}}};
    CHECK(document_of(bytes_of(document, false)).header["arguments"][0] == "caf\xef\xbf\xbd");
}

}  // namespace
