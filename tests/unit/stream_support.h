// stream_support.h: streams in memory, in files and in pipes for the tests of lib/io, and the sentence of a refusal.
#pragma once

#include <unistd.h>

#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "io/document.h"
#include "io/write_document.h"

namespace kiln::test {

using File = std::unique_ptr<std::FILE, decltype(&std::fclose)>;

/// A regular file, without a name, that holds the bytes.
inline File file_of(const std::string& bytes) {
    File file(std::tmpfile(), &std::fclose);
    std::fwrite(bytes.data(), 1, bytes.size(), file.get());
    std::rewind(file.get());
    return file;
}

/// A pipe through which the bytes come while somebody reads.
class PipeOf {
   public:
    explicit PipeOf(std::string bytes) {
        int ends[2];
        if (pipe(ends) != 0) throw std::runtime_error("no pipe");
        reading_ = fdopen(ends[0], "rb");
        writer_ = std::thread([bytes = std::move(bytes), end = ends[1]] {
            for (std::size_t done = 0; done < bytes.size();) {
                const ssize_t written = ::write(end, bytes.data() + done, bytes.size() - done);
                if (written <= 0) break;
                done += static_cast<std::size_t>(written);
            }
            close(end);
        });
    }
    ~PipeOf() {
        for (char scrap[4096]; std::fread(scrap, 1, sizeof scrap, reading_) > 0;) continue;  // lets the writer end
        writer_.join();
        std::fclose(reading_);
    }
    std::FILE* get() { return reading_; }

   private:
    std::FILE* reading_;
    std::thread writer_;
};

inline std::vector<io::Document> documents_of(std::FILE* file) {
    io::DocumentReader reader(file, "stream");
    std::vector<io::Document> documents;
    for (io::Document document; reader.next(document);) documents.push_back(std::move(document));
    return documents;
}

inline std::vector<io::Document> documents_of(const std::string& bytes) { return documents_of(file_of(bytes).get()); }

inline io::Document document_of(const std::string& bytes) { return documents_of(bytes).at(0); }

/// The bytes of a document.
inline std::string bytes_of(const io::Document& document, bool text) {
    const File file = file_of("");
    io::write_document(file.get(), "stream", document, text);
    std::string bytes(static_cast<std::size_t>(std::ftell(file.get())), ' ');
    std::rewind(file.get());
    bytes.resize(std::fread(bytes.data(), 1, bytes.size(), file.get()));
    return bytes;
}

/// What an Error said; empty where none was thrown.
inline std::string sentence_of(const std::function<void()>& action) {
    try {
        action();
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

inline std::string contents_of(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// A folder of its own for a test, deleted with what it holds.
class Folder {
   public:
    Folder() {
        std::string name = (std::filesystem::temp_directory_path() / "kiln-test-XXXXXX").string();
        if (!mkdtemp(name.data())) throw std::runtime_error("no temporary folder");
        path_ = name;
    }
    ~Folder() { std::filesystem::remove_all(path_); }
    std::string operator/(const std::string& name) const { return path_ + "/" + name; }
    std::size_t size() const {
        const std::filesystem::directory_iterator first(path_), end;
        return static_cast<std::size_t>(std::distance(first, end));
    }

   private:
    std::string path_;
};

}  // namespace kiln::test
