// document.h: the stream of documents, a JSON line each with binary arrays behind it; docs/dem-state.5 is its specification.
#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include "core/array.h"
#include "core/types.h"
#include "io/json.h"

namespace kiln::io {

/// An Error whose sentence begins with the file or the document that it is about.
struct PlacedError : Error {
    using Error::Error;
};

/// One document: its JSON header without the arrays, and the arrays under "particles", "bonds" and "necks" in the order they
/// stood.
struct Document {
    Json header;
    std::vector<NamedArray> particles;
    std::vector<NamedArray> bonds, necks;
    bool has_bonds = false, has_necks = false;
    std::string place;  // "file, document 3", for messages
};

/// Reads documents one after the other from an open file or pipe.
class DocumentReader {
   public:
    /// file stays the caller's; name is what messages call it.
    DocumentReader(std::FILE* file, std::string name);

    /// Fills the next document; false at the end of the stream.
    /// Throws Error that names the file, the document and what was required: truncation, bad JSON, a repeated key, unknown array
    /// type, shape or size that disagree, a payload longer than the file. Memory taken never runs ahead of the bytes that have
    /// arrived.
    /// "particles", "bonds" or "necks" that are no objects stay in the header: only a dem-state says that they must be arrays.
    bool next(Document& document);

   private:
    void check_readable() const;
    bool find_document();
    Json read_header(const std::string& place);
    void read_arrays(Document& document, std::uint64_t bytes);

    std::FILE* file_;
    std::string name_;
    std::size_t number_ = 0;
};

}  // namespace kiln::io
