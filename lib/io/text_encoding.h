// text_encoding.h: text files of other programs, whatever their encoding, as UTF-8.
#pragma once

#include <string>

namespace kiln::io {

/// The text of a file: UTF-8, UTF-16 (with a byte order mark, or known by the zero of every other byte), else Windows-1252, of
/// which Latin-1 is a part. Without byte order mark. Throws Error that begins with `name` and says what the file is where it is no
/// text: compressed, a workbook, or bytes of control.
std::string utf8_text(std::string bytes, const std::string& name);

}  // namespace kiln::io
