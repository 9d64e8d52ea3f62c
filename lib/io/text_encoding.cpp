// text_encoding.cpp: UTF-8 out of the encodings of machines' exports.
#include "io/text_encoding.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

#include "core/types.h"

namespace kiln::io {

namespace {

/// How a file begins that is no text, and what it is.
struct Signature {
    std::string_view begins, what;
};

constexpr std::array signatures{
    Signature{"\x1f\x8b", "is compressed (gzip); unpack it first, as gunzip does"},
    Signature{"BZh", "is compressed (bzip2); unpack it first, as bunzip2 does"},
    Signature{"\xfd""7zXZ", "is compressed (xz); unpack it first, as unxz does"},
    Signature{"(\xb5/\xfd", "is compressed (zstd); unpack it first, as unzstd does"},
    Signature{"PK\x03\x04", "is a workbook or an archive (zip), no text; save its table as CSV"},
    Signature{"\xd0\xcf\x11\xe0", "is a workbook (xls), no text; save its table as CSV"},
};

/// Code points of the bytes 0x80 to 0x9f of Windows-1252; 0 for the five that have none.
constexpr std::array<std::uint16_t, 32> windows_1252{
    0x20ac, 0,      0x201a, 0x0192, 0x201e, 0x2026, 0x2020, 0x2021, 0x02c6, 0x2030, 0x0160, 0x2039, 0x0152, 0, 0x017d, 0,
    0,      0x2018, 0x2019, 0x201c, 0x201d, 0x2022, 0x2013, 0x2014, 0x02dc, 0x2122, 0x0161, 0x203a, 0x0153, 0, 0x017e, 0x0178};

std::uint8_t byte_at(std::string_view bytes, std::size_t at) { return static_cast<std::uint8_t>(bytes[at]); }

void append(std::string& text, std::uint32_t code) {
    const auto tail = [&](int shift) { text += static_cast<char>(0x80 | ((code >> shift) & 0x3f)); };
    if (code < 0x80) {
        text += static_cast<char>(code);
    } else if (code < 0x800) {
        text += static_cast<char>(0xc0 | (code >> 6));
        tail(0);
    } else if (code < 0x10000) {
        text += static_cast<char>(0xe0 | (code >> 12));
        tail(6);
        tail(0);
    } else {
        text += static_cast<char>(0xf0 | (code >> 18));
        tail(12);
        tail(6);
        tail(0);
    }
}

/// Length of the well-formed UTF-8 character that starts there; 0 where there is none (The Unicode Standard, table 3-7).
std::size_t utf8_length(std::string_view bytes, std::size_t at) {
    const std::uint8_t first = byte_at(bytes, at);
    if (first < 0x80) return 1;
    const std::size_t length = first < 0xc2 ? 0 : first < 0xe0 ? 2 : first < 0xf0 ? 3 : first < 0xf5 ? 4 : 0;
    if (length == 0 || at + length > bytes.size()) return 0;
    std::uint8_t lower = 0x80, upper = 0xbf;  // of the second byte: no longer form than needed, no surrogates, no more than 10ffff
    if (first == 0xe0) lower = 0xa0;
    if (first == 0xed) upper = 0x9f;
    if (first == 0xf0) lower = 0x90;
    if (first == 0xf4) upper = 0x8f;
    for (std::size_t next = at + 1; next < at + length; ++next, lower = 0x80, upper = 0xbf)
        if (byte_at(bytes, next) < lower || byte_at(bytes, next) > upper) return 0;
    return length;
}

bool is_utf8(std::string_view bytes) {
    for (std::size_t at = 0; at < bytes.size();) {
        const std::size_t length = utf8_length(bytes, at);
        if (length == 0) return false;
        at += length;
    }
    return true;
}

std::string line_place(const std::string& name, std::string_view text) {
    return name + ", line " + std::to_string(std::ranges::count(text, '\n') + 1);
}

std::string from_windows_1252(std::string_view bytes, const std::string& name) {
    std::string text;
    for (std::size_t at = 0; at < bytes.size(); ++at) {
        const std::uint8_t byte = byte_at(bytes, at);
        const std::uint32_t code = byte < 0x80 || byte >= 0xa0 ? byte : windows_1252[byte - 0x80u];
        if (code == 0 && byte != 0) throw Error(line_place(name, text) + ": is neither UTF-8 nor Latin-1 text");
        append(text, code);
    }
    return text;
}

std::string from_utf16(std::string_view bytes, bool big_endian, const std::string& name) {
    std::string text;
    const auto unit = [&](std::size_t at) -> std::uint32_t {
        const std::uint32_t first = byte_at(bytes, at), second = byte_at(bytes, at + 1);
        return big_endian ? first << 8 | second : second << 8 | first;
    };
    const auto refuse = [&] { throw Error(line_place(name, text) + ": is not whole UTF-16 text"); };
    for (std::size_t at = 0; at < bytes.size(); at += 2) {
        if (at + 1 == bytes.size()) refuse();
        std::uint32_t code = unit(at);
        if (code >= 0xd800 && code < 0xe000) {  // a surrogate, the first of two
            if (code >= 0xdc00 || at + 3 >= bytes.size() || unit(at + 2) < 0xdc00 || unit(at + 2) > 0xdfff) refuse();
            at += 2;
            code = 0x10000 + ((code - 0xd800) << 10) + (unit(at) - 0xdc00);
        }
        append(text, code);
    }
    return text;
}

std::string decoded(std::string bytes, const std::string& name) {
    const std::string_view all = bytes;
    if (all.starts_with("\xff\xfe")) return from_utf16(all.substr(2), false, name);
    if (all.starts_with("\xfe\xff")) return from_utf16(all.substr(2), true, name);
    if (bytes.size() >= 4 && bytes[0] != 0 && bytes[1] == 0 && bytes[2] != 0 && bytes[3] == 0) return from_utf16(all, false, name);
    if (bytes.size() >= 4 && bytes[0] == 0 && bytes[1] != 0 && bytes[2] == 0 && bytes[3] != 0) return from_utf16(all, true, name);
    if (!all.starts_with("\xef\xbb\xbf")) return is_utf8(all) ? bytes : from_windows_1252(all, name);
    if (!is_utf8(all)) throw Error(name + ": begins with the mark of UTF-8 and is none");
    return bytes.substr(3);
}

}  // namespace

std::string utf8_text(std::string bytes, const std::string& name) {
    for (const Signature& signature : signatures)
        if (bytes.starts_with(signature.begins)) throw Error(name + ": " + std::string(signature.what));
    std::string text = decoded(std::move(bytes), name);
    if (text.ends_with('\x1a')) text.pop_back();  // end of a file of DOS
    const auto control = [](char c) { return (c >= 0 && c < ' ' && c != '\t' && c != '\n' && c != '\r') || c == 0x7f; };
    const auto found = std::ranges::find_if(text, control);
    if (found != text.end())
        throw Error(line_place(name, std::string_view(text.begin(), found)) + ": has the control character " +
                    std::to_string(static_cast<int>(*found)) + ", so it is no text");
    return text;
}

}  // namespace kiln::io
