// document_refusal_test.cpp: what the reader refuses, with the sentence it gives, in files and pipes, in little time and memory.
#include <doctest/doctest.h>
#include <sys/resource.h>

#include <chrono>

#include "tests/unit/stream_support.h"
#include "io/json_line.h"
#include "io/json_values.h"

namespace {

using namespace kiln;
using namespace kiln::test;

std::string repeated(const std::string& text, std::size_t times) {
    std::string all;
    for (std::size_t time = 0; time < times; ++time) all += text;
    return all;
}

/// What the reader says of a stream; a file and a pipe must give the same sentence.
std::string refusal(const std::string& stream) {
    PipeOf pipe(stream);
    const std::string of_pipe = sentence_of([&] { documents_of(pipe.get()); });
    const std::string of_file = sentence_of([&] { documents_of(stream); });
    CHECK(of_pipe == of_file);
    return of_file;
}

std::string with_array(const std::string& spec) { return R"({"particles":{"x":)" + spec + "}}\n"; }

/// Forgets the peak that earlier tests left, where the system lets us.
void reset_peak_memory() { std::ofstream("/proc/self/clear_refs") << "5"; }

/// Greatest memory that this program had since then, bytes.
std::size_t peak_memory() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::size_t>(usage.ru_maxrss) * 1024;
}

TEST_CASE("a stream that holds no document is at its end") {
    for (const char* stream : {"", "\n", "  \r\n\t\n"}) CHECK(documents_of(std::string(stream)).empty());
}

TEST_CASE("what is no line of JSON is refused, with the place") {
    CHECK(refusal("hello") == "stream, document 1: begins with byte 104, expected '{', the beginning of a JSON object");
    CHECK(refusal("\x1f\x8b\x08") ==
          "stream, document 1: is compressed (gzip), expected a JSON object; unpack it first, as gunzip does");
    CHECK(refusal("[1]\n") == "stream, document 1: begins with byte 91, expected '{', the beginning of a JSON object");
    CHECK(refusal("\xef\xbb\xbf{}\n") == "stream, document 1: begins with byte 239, expected '{', the beginning of a JSON object");
    CHECK(refusal("{}\n{}\n{\"a\":}\n") == "stream, document 3: is not a line of JSON (byte 6)");
    CHECK(refusal("{} {}\n") == "stream, document 1: is not a line of JSON (byte 4)");
    CHECK(refusal("{\"a\":NaN}\n") == "stream, document 1: is not a line of JSON (byte 6)");
    CHECK(refusal("{\"a\":-inf}\n") == "stream, document 1: is not a line of JSON (byte 7)");
    CHECK(refusal("{\"a\":\"\xff\"}\n") == "stream, document 1: is not a line of JSON (byte 7)");
    CHECK(refusal(std::string("{}\0{}\n", 6)) == "stream, document 1: is not a line of JSON (byte 3)");
    CHECK(refusal("{\"a\":1e999}\n") == "stream, document 1: has a number too large for a double (byte 10)");
}

TEST_CASE("a key that stands twice is refused at every level") {
    CHECK(refusal("{\"a\":1,\"a\":1}\n") == "stream, document 1: key 'a' stands twice");
    CHECK(refusal("{\"b\":[{\"c\":{\"a\":1,\"d\":{\"a\":2},\"a\":3}}]}\n") == "stream, document 1: key 'a' stands twice");
    CHECK(refusal("{\"a\":{\"a\":[{\"a\":1},{\"a\":1}]}}\n").empty());
}

TEST_CASE("nesting and keys have limits, and no line takes long") {
    const auto start = std::chrono::steady_clock::now();
    const auto nested = [](std::size_t levels) {
        return "{\"a\":" + repeated("[", levels - 1) + repeated("]", levels - 1) + "}\n";
    };
    CHECK(refusal(nested(io::deepest_nesting)).empty());
    CHECK(refusal(nested(io::deepest_nesting + 1)) == "stream, document 1: is nested deeper than 64 levels");
    CHECK(refusal("{\"a\":" + repeated("[", 1000000)) ==
          "stream, document 1: is truncated: it ends inside its header, after 1000005 bytes");
    CHECK(refusal(repeated("{\"a\":", 1000000) + "\n") == "stream, document 1: is nested deeper than 64 levels");
    const auto keys = [](std::size_t count) {
        std::string line = "{\"0\":0";
        for (std::size_t key = 1; key < count; ++key) line += ",\"" + std::to_string(key) + "\":0";
        return line + "}\n";
    };
    CHECK(refusal(keys(io::max_keys)).empty());
    CHECK(refusal(keys(io::max_keys + 1)) == "stream, document 1: has an object of more than 1024 keys");
    CHECK(refusal("{\"a\":[" + repeated("{},", 300000) + "{}]}\n").empty());
    CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(20));
}

TEST_CASE("a long datum is cut in the sentence, not inside a character") {
    CHECK(io::clipped(std::string(60, 'a')) == std::string(60, 'a'));
    CHECK(io::clipped(std::string(61, 'a')) == std::string(60, 'a') + "…");
    CHECK(io::clipped(std::string(59, 'a') + "éa") == std::string(59, 'a') + "…");
    CHECK(refusal("{\"" + std::string(5000, 'k') + "\":1,\"" + std::string(5000, 'k') + "\":1}\n").size() < 120);
}

TEST_CASE("what is no array is refused") {
    const std::string no_array = R"(is not an array {"type":…,"shape":…,"data" or "at":…})";
    CHECK(refusal(with_array("[1,2]")) == "stream, document 1: particles.x: " + no_array);
    CHECK(refusal(with_array("{}")) == "stream, document 1: particles.x: " + no_array);
    CHECK(refusal(with_array(R"({"type":8})")) == "stream, document 1: particles.x: " + no_array);
    CHECK(refusal(with_array(R"({"type":"f16","shape":[0],"data":[]})")) ==
          "stream, document 1: particles.x: type \"f16\" is unknown; there are f8, f4, i8, i4, i2, i1, u1");
    CHECK(refusal(with_array(R"({"type":"f8","shape":[0]})")) == "stream, document 1: particles.x: needs either data or at");
    CHECK(refusal(with_array(R"({"type":"f8","shape":[0],"at":0,"data":[]})")) ==
          "stream, document 1: particles.x: needs either data or at");
    CHECK(refusal(R"({"bonds":{"y":5}})" "\n") == "stream, document 1: bonds.y: " + no_array);
}

TEST_CASE("what is no shape is refused") {
    const auto shape = [](const std::string& text) {
        return refusal(with_array(R"({"type":"f8","shape":)" + text + R"(,"data":[]})"));
    };
    for (const char* none : {"3", "[]", "null", "\"3\""})
        CHECK(shape(none) == "stream, document 1: particles.x: has no shape, a list of sizes such as [N,3]");
    for (const char* wrong : {"[-1]", "[1.5]", "[\"a\"]", "[null]", "[2147483648]", "[18446744073709551615]", "[1,[2]]"})
        CHECK(shape(wrong) == "stream, document 1: particles.x: shape " + std::string(wrong) + " is not a list of sizes");
    CHECK(shape("[2147483647,2147483647,2147483647]") ==
          "stream, document 1: particles.x: shape [2147483647,2147483647,2147483647] is larger than any memory");
}

TEST_CASE("text data that does not fit shape or type is refused, with the value") {
    const auto data = [](const std::string& type, const std::string& text) {
        return refusal(with_array(R"({"type":")" + type + R"(","shape":[2],"data":)" + text + "}"));
    };
    const std::string place = "stream, document 1: particles.x: ";
    CHECK(data("f8", "[1]") == place + "has 1 values of data where its shape requires 2");
    CHECK(data("f8", "[1,2,3]") == place + "has 3 values of data where its shape requires 2");
    CHECK(data("f8", "5") == place + "has 0 values of data where its shape requires 2");
    CHECK(data("f8", "[1,null]") == place + "value 1 is null where a number is needed");
    CHECK(data("f8", "[\"nan\",1]") == place + "value 0 is \"nan\" where a number is needed");
    CHECK(data("f8", "[[1],2]") == place + "value 0 is [1] where a number is needed");
    CHECK(data("f8", "[true,2]") == place + "value 0 is true where a number is needed");
    CHECK(data("f4", "[1,1e39]") == place + "value 1 is 1e+39 where a number that fits the array's type is needed");
    CHECK(data("i4", "[1,2.0]") == place + "value 1 is 2.0 where a whole number is needed");
    for (const auto& [type, value] : {std::pair{"i1", "128"}, {"i1", "-129"}, {"u1", "-1"}, {"u1", "256"}, {"i2", "32768"},
                                      {"i4", "2147483648"}, {"i8", "9223372036854775808"}, {"i8", "18446744073709551615"}})
        CHECK(data(type, "[0," + std::string(value) + "]") ==
              place + "value 1 is " + value + " where a number that fits the array's type is needed");
}

TEST_CASE("a truncated document says how much was wanted") {
    const std::string header = R"({"particles":{"x":{"type":"f8","shape":[3],"at":0}},"bytes":64})";
    const std::string place = "stream, document 1: is truncated: ";
    CHECK(refusal(header + "\n" + std::string(63, 'x')) == place + "64 bytes belong behind its header, 63 are there");
    CHECK(refusal(header + "\n" + std::string(5, 'x')) == place + "64 bytes belong behind its header, 5 are there");
    CHECK(refusal(header + "\n") == place + "64 bytes belong behind its header, 0 are there");
    CHECK(refusal(header) == place + "it ends with its header, but bytes belong behind it");
    CHECK(refusal(header.substr(0, 40)) == place + "it ends inside its header, after 40 bytes");
    const std::string whole = header + "\n" + std::string(64, '\0');
    CHECK(refusal(whole).empty());
    for (std::size_t length = 1; length < whole.size(); ++length) CHECK_FALSE(refusal(whole.substr(0, length)).empty());
    CHECK(refusal(whole + whole.substr(0, 90)) == "stream, document 2: is truncated: 64 bytes belong behind its header, " +
                                                      std::to_string(90 - header.size() - 1) + " are there");
}

TEST_CASE("binary arrays stay inside the payload and apart from each other") {
    const auto arrays = [](const std::string& x, const std::string& y, const std::string& bytes) {
        return refusal(R"({"particles":{"x":{"type":"f8","shape":[2],"at":)" + x + R"(},"y":{"type":"i4","shape":[2],"at":)" + y +
                       R"(}},"bytes":)" + bytes + "}\n" + std::string(64, '\0'));
    };
    const std::string place = "stream, document 1: ";
    CHECK(arrays("0", "16", "64").empty());
    CHECK(arrays("48", "40", "64").empty());
    CHECK(arrays("49", "0", "64") == place + "particles.x: reaches beyond the 64 bytes of the document");
    CHECK(arrays("0", "57", "64") == place + "particles.y: reaches beyond the 64 bytes of the document");
    CHECK(arrays("18446744073709551615", "0", "64") == place + "particles.x: reaches beyond the 64 bytes of the document");
    CHECK(arrays("0", "15", "64") == place + "particles.y: overlaps another array");
    CHECK(arrays("0", "0", "64") == place + "particles.y: overlaps another array");
    for (const char* wrong : {"-1", "1.0", "\"0\"", "null"})
        CHECK(arrays(wrong, "0", "64") == place + "particles.x: at is not an offset in bytes");
    for (const char* wrong : {"-1", "64.0", "\"64\"", "null", "1e3"})
        CHECK(arrays("0", "16", wrong).starts_with(place + "bytes is "));
    for (const char* none : {R"({"type":"f8","shape":[1],"at":0})", R"({"type":"f8","shape":[0],"at":1})"})
        CHECK(refusal(with_array(none)) == place + "particles.x: reaches beyond the 0 bytes of the document");
}

TEST_CASE("sizes that no file has take no memory, of a file or a pipe") {
    reset_peak_memory();
    const std::size_t before = peak_memory();
    const std::string tera = R"({"particles":{"x":{"type":"u1","shape":[2000000000,1000],"at":0}},"bytes":2000000000000})";
    CHECK(refusal(tera + "\n") ==
          "stream, document 1: is truncated: 2000000000000 bytes belong behind its header, 0 are there");
    CHECK(refusal(tera + "\n" + std::string(3 << 20, 'x')) ==
          "stream, document 1: is truncated: 2000000000000 bytes belong behind its header, 3145728 are there");
    CHECK(refusal("{\"bytes\":18446744073709551615}\n123") ==
          "stream, document 1: is truncated: 18446744073709551615 bytes belong behind its header, 3 are there");
    CHECK(refusal(with_array(R"({"type":"i8","shape":[2000000000,500000000],"data":[1]})")) ==
          "stream, document 1: particles.x: has 1 values of data where its shape requires 1000000000000000000");
    CHECK(peak_memory() - before < std::size_t{64} << 20);
}

TEST_CASE("a folder cannot be read as a stream") {
    const File folder(std::fopen("/", "rb"), &std::fclose);
    CHECK(sentence_of([&] { documents_of(folder.get()); }) == "stream: cannot be read: Is a directory");
}

}  // namespace
