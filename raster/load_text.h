// Lines, words and numbers of text model files (OBJ, MTL, ascii PLY): no locale, the same bits everywhere.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace pac::raster {

// Yields a file's lines: ended by LF, CR LF, CR or the end of the file. Keeps a pointer to the caller's bytes; each
// line is valid until the next one is read.
class LineReader {
 public:
  // joins: lines that end in a backslash go on in the next one, unless they are '#' comments.
  LineReader(std::span<const uint8_t> bytes, size_t at, bool joins) : bytes_(bytes), at_(at), joins_(joins) {}

  // False at the end of the file.
  bool next();
  std::string_view line() const { return line_; }
  size_t offset() const { return offset_; }  // of the line's first byte
  size_t end() const { return at_; }         // of the byte after the line and its end

 private:
  std::string_view physical_line();

  std::span<const uint8_t> bytes_;
  size_t at_ = 0, offset_ = 0;
  bool joins_ = false;
  std::string_view line_;
  std::string joined_;
};

// How many bytes of a UTF-8 byte order mark `bytes` start with (0 or 3).
size_t byte_order_mark_size(std::span<const uint8_t> bytes);
// UTF-16 or UTF-32 text: a byte order mark, or a zero among the first four bytes.
bool is_wide_text(std::span<const uint8_t> bytes);

// Without white space (blank, tab, VT, FF, CR) at both ends.
std::string_view trimmed(std::string_view text);
// Takes the first word off `text`; empty at the end.
std::string_view take_word(std::string_view& text);
// Up to a '#' that starts a word.
std::string_view without_comment(std::string_view text);

enum class NumberKind : uint8_t { finite, not_finite, malformed };

// The whole of `word` as a decimal number: [+-] digits [. digits] [e [+-] digits], digits before or after the point.
// Words for NaN and infinity, and numbers beyond a float's range, are not_finite and set 0. At most 19 significant
// digits count; the double before the rounding to float is within 2 units in the last place of the exact value.
NumberKind parse_float(std::string_view word, float& value);

// [+-] digits, saturated to +-2^62. False if malformed.
bool parse_integer(std::string_view word, int64_t& value);

}  // namespace pac::raster
