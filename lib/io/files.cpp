// files.cpp: opening, checking and renaming of the files behind a stream.
#include "io/files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <climits>
#include <cstdlib>
#include <cstring>

#include "io/state_io.h"

namespace kiln::io {

namespace {

std::string system_cause() { return std::strerror(errno); }

/// The file behind a chain of symbolic links, so that a rename replaces the file and not the link.
std::string resolved(const std::string& name) {
    char* path = realpath(name.c_str(), nullptr);
    if (!path) return name;
    std::string result = path;
    std::free(path);
    return result;
}

}  // namespace

Input::Input(std::vector<std::string> files) : files_(std::move(files)) {
    if (files_.empty()) files_.push_back("-");
}

Input::~Input() {
    if (file_ && file_ != stdin) std::fclose(file_);
}

std::optional<Document> Input::next() {
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
        file_ = name == "-" ? stdin : std::fopen(name.c_str(), "rb");
        if (!file_) throw Error(name + ": cannot be opened: " + system_cause());
        reader_ = std::make_unique<DocumentReader>(file_, name == "-" ? "standard input" : name);
    }
}

std::optional<State> Input::next_state() {
    std::optional<Document> document = next();
    if (!document) return std::nullopt;
    return state_from(std::move(*document));
}

Output::Output(std::string name, bool text) : name_(std::move(name)), text_(text) {
    if (name_ == "-") {
        if (!text_ && isatty(STDOUT_FILENO)) throw Error("binary documents do not go to a terminal; use -o FILE, a pipe, or --text");
        name_ = "standard output";
        file_ = stdout;
        return;
    }
    name_ = resolved(name_);
    struct stat status {};
    if (stat(name_.c_str(), &status) == 0 && !S_ISREG(status.st_mode)) {  // a device or a pipe has no whole to wait for
        file_ = std::fopen(name_.c_str(), "wb");
    } else {
        partial_ = name_ + ".partial-" + std::to_string(getpid());
        file_ = std::fopen(partial_.c_str(), "wb");
    }
    if (!file_) {
        const std::string cause = system_cause();
        partial_.clear();
        throw Error(name_ + ": cannot be written: " + cause);
    }
}

Output::~Output() {
    if (file_ && file_ != stdout) std::fclose(file_);
    if (!partial_.empty()) unlink(partial_.c_str());
}

void Output::write(const Document& document) {
    write_document(file_, name_, document, text_);
    if (partial_.empty() && std::fflush(file_) != 0) {  // the next program of a pipe starts as soon as it can
        if (errno == EPIPE) throw ClosedPipe();
        throw Error(name_ + ": cannot be written: " + system_cause());
    }
}

void Output::write(State state) { write(document_from(std::move(state))); }

void Output::write(const Json& line) {
    Document document;
    document.header = line;
    write(document);
}

void Output::write_text(const std::string& text) {
    if (std::fwrite(text.data(), 1, text.size(), file_) == text.size()) return;
    if (errno == EPIPE) throw ClosedPipe();
    throw Error(name_ + ": cannot be written: " + system_cause());
}

void Output::commit() {
    errno = 0;
    const bool flushed = std::fflush(file_) == 0;
    const int cause = errno;
    const bool closed = std::fclose(file_) == 0;
    file_ = nullptr;
    if (!flushed || !closed) {
        if (!flushed) errno = cause;
        if (errno == EPIPE) throw ClosedPipe();
        throw Error(name_ + ": cannot be written: " + system_cause());
    }
    if (partial_.empty()) return;
    if (std::rename(partial_.c_str(), name_.c_str()) != 0) throw Error(name_ + ": cannot be renamed into place: " + system_cause());
    partial_.clear();
}

}  // namespace kiln::io
