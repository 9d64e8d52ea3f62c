// files_test.cpp: inputs one after the other, and outputs that are whole under their name or not there.
#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/stat.h>

#include <csignal>

#include "io/files.h"
#include "tests/unit/stream_support.h"

namespace {

using namespace kiln;
using namespace kiln::test;

void put(const std::string& path, const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

void write_and_commit(const std::string& path, const Json& line) {
    io::Output output(path, true);
    output.write(line);
    output.commit();
}

TEST_CASE("the documents of several files come one after the other") {
    const Folder folder;
    put(folder / "a", "{\"n\":1}\n{\"n\":2}\n");
    put(folder / "b", "{\"n\":3}");
    put(folder / "none", "");
    io::Input input({folder / "a", folder / "none", folder / "b"});
    for (int wanted = 1; wanted <= 3; ++wanted) CHECK(input.next()->header["n"] == wanted);
    CHECK_FALSE(input.next());
    CHECK_FALSE(input.next());
}

TEST_CASE("what cannot be read is said with its name") {
    const Folder folder;
    put(folder / "none", "\n");
    put(folder / "bad", "{}\nx\n");
    CHECK(sentence_of([&] { io::Input({folder / "absent"}).next(); }) ==
          folder / "absent: cannot be opened: No such file or directory");
    CHECK(sentence_of([&] { io::Input({folder / "none"}).next(); }) == folder / "none: holds no document");
    CHECK(sentence_of([&] { io::Input({folder / ""}).next(); }) == folder / ": cannot be read: Is a directory");
    CHECK(sentence_of([&] {
              io::Input input({folder / "bad"});
              input.next();
              input.next();
          }) == folder / "bad, document 2: begins with byte 120, expected '{', the beginning of a JSON object");
    put(folder / "result", R"({"format":"dem-bend"})");
    CHECK(sentence_of([&] { io::Input({folder / "result"}).next_state(); }) ==
          folder / "result, document 1: is \"dem-bend\", expected dem-state");
}

TEST_CASE("nothing stands under the final name before commit, and nothing at all without it") {
    const Folder folder;
    {
        io::Output output(folder / "out", true);
        output.write(Json{{"n", 1}});
        output.write_text("more\n");
        CHECK(contents_of(folder / "out").empty());
        CHECK_FALSE(std::filesystem::exists(folder / "out"));
        output.commit();
        CHECK(contents_of(folder / "out") == "{\"n\":1}\nmore\n");
        CHECK(folder.size() == 1);
    }
    {
        io::Output output(folder / "other", true);
        output.write(Json{{"n", 1}});
        CHECK(folder.size() == 2);
    }
    CHECK(folder.size() == 1);
}

TEST_CASE("a file that is there stays as it was until commit, and keeps its permissions") {
    const Folder folder;
    put(folder / "out", "before");
    chmod((folder / "out").c_str(), 0640);
    {
        io::Output output(folder / "out", true);
        output.write(Json{{"n", 1}});
    }
    CHECK(contents_of(folder / "out") == "before");
    CHECK(folder.size() == 1);
    write_and_commit(folder / "out", {{"n", 2}});
    CHECK(contents_of(folder / "out") == "{\"n\":2}\n");
    struct stat status {};
    REQUIRE(stat((folder / "out").c_str(), &status) == 0);
    CHECK((status.st_mode & 0777) == 0640);
}

TEST_CASE("an input may be its own output") {
    const Folder folder;
    put(folder / "same", "{\"n\":1}\n{\"n\":2}\n");
    io::Input input({folder / "same"});
    io::Output output(folder / "same", true);
    while (auto document = input.next()) {
        document->header["n"] = 10 * document->header["n"].get<int>();
        output.write(*document);
    }
    output.commit();
    CHECK(contents_of(folder / "same") == "{\"n\":10}\n{\"n\":20}\n");
}

TEST_CASE("symbolic links stay links, also where they lead to nothing yet") {
    const Folder folder;
    std::filesystem::create_directory(folder / "deep");
    put(folder / "deep/file", "before");
    std::filesystem::create_symlink("deep/link", folder / "link");
    std::filesystem::create_symlink("file", folder / "deep/link");
    std::filesystem::create_symlink("deep/absent", folder / "dangling");
    write_and_commit(folder / "link", {{"n", 1}});
    write_and_commit(folder / "dangling", {{"n", 2}});
    CHECK(std::filesystem::is_symlink(folder / "link"));
    CHECK(std::filesystem::is_symlink(folder / "deep/link"));
    CHECK(std::filesystem::is_symlink(folder / "dangling"));
    CHECK(contents_of(folder / "deep/file") == "{\"n\":1}\n");
    CHECK(contents_of(folder / "deep/absent") == "{\"n\":2}\n");
    std::filesystem::create_symlink("circle", folder / "circle");
    CHECK(sentence_of([&] { io::Output(folder / "circle", true); }) ==
          folder / "circle: cannot be written: Too many levels of symbolic links");
}

TEST_CASE("two outputs of one name do not mix; the last to commit stands") {
    const Folder folder;
    io::Output first(folder / "out", true), second(folder / "out", true);
    first.write(Json{{"n", 1}});
    second.write(Json{{"n", 2}});
    second.commit();
    CHECK(contents_of(folder / "out") == "{\"n\":2}\n");
    first.commit();
    CHECK(contents_of(folder / "out") == "{\"n\":1}\n");
    CHECK(folder.size() == 1);
}

TEST_CASE("what cannot be written is said before any work") {
    const Folder folder;
    CHECK(sentence_of([&] { io::Output(folder / "no/out", true); }) ==
          folder / "no/out: cannot be written: No such file or directory");
    CHECK(sentence_of([&] { io::Output(folder / "", true); }) == folder / ": cannot be written: Is a directory");
    CHECK(sentence_of([&] { io::Output("", true); }) == "the output has an empty name");
    CHECK(folder.size() == 0);
}

TEST_CASE("a full device gives one sentence, for small output at commit and for large output at once") {
    io::Output small("/dev/full", true);
    CHECK(sentence_of([&] { small.write(Json{{"n", 1}}); }) == "/dev/full: cannot be written: No space left on device");
    io::Output late("/dev/full", true);
    late.write_text("x");
    CHECK(sentence_of([&] { late.commit(); }) == "/dev/full: cannot be written: No space left on device");
    io::Output large("/dev/full", true);
    CHECK(sentence_of([&] { large.write_text(std::string(1 << 20, 'x')); }) ==
          "/dev/full: cannot be written: No space left on device");
}

TEST_CASE("a device is written and not replaced") {
    write_and_commit("/dev/null", {{"n", 1}});
    struct stat status {};
    REQUIRE(stat("/dev/null", &status) == 0);
    CHECK(S_ISCHR(status.st_mode));
}

TEST_CASE("a reader that goes away ends an output with ClosedPipe") {
    std::signal(SIGPIPE, SIG_IGN);  // as tools/common does for the tools
    const Folder folder;
    REQUIRE(mkfifo((folder / "pipe").c_str(), 0600) == 0);
    const int reader = open((folder / "pipe").c_str(), O_RDONLY | O_NONBLOCK);
    io::Output output(folder / "pipe", true);
    output.write(Json{{"n", 1}});
    close(reader);
    CHECK_THROWS_AS(output.write(Json{{"n", 2}}), io::ClosedPipe);
    CHECK(std::filesystem::is_fifo(folder / "pipe"));
}

TEST_CASE("errno becomes a closed pipe, an interruption or a sentence") {
    errno = EPIPE;
    CHECK_THROWS_AS(io::throw_system_error("x"), io::ClosedPipe);
    errno = EINTR;
    CHECK_THROWS_AS(io::throw_system_error("x"), Interrupted);
    CHECK(sentence_of([] {
              errno = ENOSPC;
              io::throw_system_error("x");
          }) == "x: No space left on device");
}

}  // namespace
