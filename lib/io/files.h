// files.h: input from files and stdin, output to stdout or to a file that appears under its name only when it is whole.
#pragma once

#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/state.h"
#include "core/stop.h"
#include "io/document.h"

namespace kiln::io {

/// The reader of the stream went away; the tool ends silently.
struct ClosedPipe : std::exception {};

/// Turns errno into ClosedPipe, Interrupted (a signal ended a wait for input or for room in a pipe), or
/// PlacedError "<sentence>: <cause>"; the sentence begins with the name of the file.
[[noreturn]] void throw_system_error(const std::string& sentence);

/// The documents of several files, one after the other; no file, or "-", is stdin.
class Input {
   public:
    /// stop: asked before each document; where it says true Interrupted is thrown. A signal that comes while a program works would
    /// otherwise be forgotten in the next wait.
    explicit Input(std::vector<std::string> files, StopRequest stop = {});
    ~Input();

    /// Next document; nothing at the end. Throws Error for a file that cannot be opened or read, or if there was no document at
    /// all.
    std::optional<Document> next();

    /// Next document as a state; throws Error where it is another kind of document.
    std::optional<State> next_state();

   private:
    std::vector<std::string> files_;
    StopRequest stop_;
    std::size_t opened_ = 0;
    std::size_t documents_ = 0;
    std::FILE* file_ = nullptr;
    std::unique_ptr<DocumentReader> reader_;
};

/// For a run that may be interrupted and resumed: the file being written is NAME.partial and stays where the run is interrupted.
struct Resumption {
    bool take_up = false;     // an earlier run's partial file, if it is there
    std::uint64_t bytes = 0;  // that are kept of it
};

/// Gives the partial file of a run that had only this left to do its final name; does nothing if that is done already.
void finish_partial(const std::string& name);

/// An output file or stdout ("-"). A file is written beside its final name and renamed by commit(); without commit() nothing
/// appears and a file of that name stays as it was. Symbolic links and permissions are kept. Devices and named pipes are written
/// as they are.
class Output {
   public:
    /// Throws Error if the file cannot be created, or if binary documents would go to a terminal.
    Output(std::string name, bool text, std::optional<Resumption> resumption = std::nullopt);
    ~Output();
    Output(const Output&) = delete;
    Output& operator=(const Output&) = delete;

    void write(const Document& document);
    void write(State state);
    /// One line of JSON.
    void write(const Json& line);
    void write_text(const std::string& text);

    /// Hands everything to the system and gives the number of bytes in the file so far. From then on the partial file of a run that
    /// may be resumed stays where it is interrupted.
    std::uint64_t flushed_bytes();

    /// Flushes, checks, and gives the file its final name. Throws Error on a full disk, ClosedPipe on a closed pipe.
    void commit();

   private:
    [[noreturn]] void fail() const;
    void create_partial();
    void open_partial(const Resumption& resumption);

    std::string name_;     // as it was given
    std::string final_;    // the regular file that it leads to; empty for a device, a pipe or standard output
    std::string partial_;  // the file being written, until it has its final name
    bool text_;
    bool keep_ = false;    // the partial file, where the run is interrupted
    std::FILE* file_ = nullptr;
};

}  // namespace kiln::io
