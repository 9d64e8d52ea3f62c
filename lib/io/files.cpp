// files.cpp: opening, checking and renaming of the files behind a stream.
#include "io/files.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include "io/state_io.h"
#include "io/write_document.h"

namespace kiln::io {

namespace {

/// The file behind a chain of symbolic links, there or not, so that a rename replaces the file and not the link.
std::filesystem::path resolved(std::filesystem::path path) {
    constexpr int longest_chain = 40;  // as in Linux
    std::error_code none;
    for (int link = 0; link < longest_chain && std::filesystem::is_symlink(path, none); ++link)
        path = path.parent_path() / std::filesystem::read_symlink(path);
    return path;
}

}  // namespace

void throw_system_error(const std::string& sentence) {
    if (errno == EPIPE) throw ClosedPipe();
    if (errno == EINTR) throw Interrupted();
    throw PlacedError(sentence + ": " + std::strerror(errno));
}

void finish_partial(const std::string& name) {
    const std::string final = resolved(name), partial = final + ".partial";
    if (std::rename(partial.c_str(), final.c_str()) != 0 && errno != ENOENT)
        throw_system_error(name + ": cannot be renamed into place");
}

Input::Input(std::vector<std::string> files, StopRequest stop) : files_(std::move(files)), stop_(std::move(stop)) {
    if (files_.empty()) files_.emplace_back("-");
}

Input::~Input() {
    if (file_ && file_ != stdin) std::fclose(file_);
}

std::optional<Document> Input::next() {
    throw_if_stopped(stop_);
    Document document;
    for (;;) {
        if (reader_ && reader_->next(document)) {
            ++documents_;
            return document;
        }
        if (opened_ == files_.size()) {
            if (documents_ == 0) throw Error((files_.back() == "-" ? "standard input" : files_.back()) + ": holds no document");
            return std::nullopt;
        }
        const std::string& name = files_[opened_++];
        reader_.reset();
        if (file_ && file_ != stdin) std::fclose(file_);
        file_ = name == "-" ? stdin : std::fopen(name.c_str(), "rbe");
        if (!file_) throw_system_error(name + ": cannot be opened");
        reader_ = std::make_unique<DocumentReader>(file_, name == "-" ? "standard input" : name);
    }
}

std::optional<State> Input::next_state() {
    std::optional<Document> document = next();
    if (!document) return std::nullopt;
    return state_from(std::move(*document));
}

Output::Output(std::string name, bool text, std::optional<Resumption> resumption)
    : name_(std::move(name)), text_(text) {
    if (name_.empty()) throw Error("the output has an empty name");
    if (name_ == "-") {
        if (!text_ && isatty(STDOUT_FILENO))
            throw Error("binary documents do not go to a terminal; use -o FILE, a pipe, or --text");
        name_ = "standard output";
        file_ = stdout;
        return;
    }
    struct stat status {};
    const bool exists = stat(name_.c_str(), &status) == 0;
    if (!exists && errno != ENOENT) fail();
    if (exists && !S_ISREG(status.st_mode)) {  // a device or a pipe has no whole to wait for
        if (resumption) throw Error(name_ + ": is no regular file, so no run can be resumed in it");
        file_ = std::fopen(name_.c_str(), "wbe");
        if (!file_) fail();
        return;
    }
    if (exists && access(name_.c_str(), W_OK) != 0) fail();
    final_ = resolved(name_);
    if (resumption)
        open_partial(*resumption);
    else
        create_partial();
    if (exists) fchmod(fileno(file_), status.st_mode & 0777);
}

/// A fresh file beside the final one. Another program, or another output of this one, may be writing the same file.
void Output::create_partial() {
    const std::string base = final_ + ".partial-" + std::to_string(getpid());
    for (int number = 0; !file_; ++number) {
        partial_ = number == 0 ? base : base + "-" + std::to_string(number);
        file_ = std::fopen(partial_.c_str(), "wbxe");
        if (file_ || errno == EEXIST) continue;
        partial_.clear();
        fail();
    }
}

void Output::open_partial(const Resumption& resumption) {
    partial_ = final_ + ".partial";
    file_ = std::fopen(partial_.c_str(), resumption.take_up ? "r+be" : "wbxe");
    keep_ = file_ && resumption.take_up;
    if (!file_ && resumption.take_up && errno == ENOENT && resumption.bytes == 0) file_ = std::fopen(partial_.c_str(), "wbxe");
    const std::string partial = file_ ? partial_ : std::exchange(partial_, std::string());
    if (!file_ && errno == EEXIST)
        throw Error(partial + ": is there already; a run is writing it, or --resume resumes the one that did");
    if (!file_ && errno == ENOENT && resumption.take_up) throw Error(partial + ": is gone, so the run cannot be resumed");
    if (!file_) fail();
    struct stat status {};
    if (fstat(fileno(file_), &status) != 0 || static_cast<std::uint64_t>(status.st_size) < resumption.bytes)
        throw Error(partial + ": is shorter than it was at the checkpoint");
    if (flock(fileno(file_), LOCK_EX | LOCK_NB) != 0) throw Error(partial + ": is being written by another run");
    const auto kept = static_cast<off_t>(resumption.bytes);
    if (ftruncate(fileno(file_), kept) != 0 || fseeko(file_, kept, SEEK_SET) != 0) fail();
}

std::uint64_t Output::flushed_bytes() {
    if (std::fflush(file_) != 0) fail();
    keep_ = true;
    const off_t bytes = ftello(file_);
    if (bytes < 0) fail();
    return static_cast<std::uint64_t>(bytes);
}

void Output::fail() const { throw_system_error(name_ + ": cannot be written"); }

Output::~Output() {
    if (file_ && file_ != stdout) std::fclose(file_);
    if (!partial_.empty() && !keep_) unlink(partial_.c_str());
}

void Output::write(const Document& document) {
    write_document(file_, name_, document, text_);
    if (partial_.empty() && std::fflush(file_) != 0) fail();  // the next program of a pipe starts as soon as it can
}

void Output::write(State state) { write(document_from(std::move(state))); }

void Output::write(const Json& line) {
    Document document;
    document.header = line;
    write(document);
}

void Output::write_text(const std::string& text) {
    if (std::fwrite(text.data(), 1, text.size(), file_) != text.size()) fail();
}

void Output::commit() {
    errno = 0;
    const bool flushed = std::fflush(file_) == 0;
    const int cause = errno;
    const bool closed = std::fclose(file_) == 0;
    file_ = nullptr;
    if (!flushed || !closed) {
        if (!flushed) errno = cause;
        fail();
    }
    if (partial_.empty()) return;
    if (std::rename(partial_.c_str(), final_.c_str()) != 0)
        throw_system_error(name_ + ": cannot be renamed into place");
    partial_.clear();
}

}  // namespace kiln::io
