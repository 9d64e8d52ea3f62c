// write_document.h: a document into a stream.
#pragma once

#include <cstdio>
#include <string>

#include "io/document.h"

namespace kiln::io {

/// Writes the document to the file: as one text line, or with binary arrays behind the header, each at a multiple of 64 bytes.
/// Throws Error that starts with name: a number that JSON cannot hold (NaN, infinity), a header key that belongs to the arrays, or
/// a file that takes no more. Throws ClosedPipe (files.h) where the reader of a pipe went away, Interrupted (core/stop.h) where a
/// signal came.
void write_document(std::FILE* file, const std::string& name, const Document& document, bool text);

}  // namespace kiln::io
