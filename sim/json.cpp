#include "sim/json.h"

#include <charconv>
#include <cmath>

namespace pac::sim {

std::string json_escaped(std::string_view text) {
  constexpr char kHex[] = "0123456789abcdef";
  std::string escaped;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      escaped += '\\';
      escaped += c;
    } else if (byte < 0x20) {
      escaped += "\\u00";
      escaped += kHex[byte >> 4];
      escaped += kHex[byte & 15];
    } else {
      escaped += c;
    }
  }
  return escaped;
}

void JsonWriter::newline() {
  text_ += '\n';
  text_.append(2 * static_cast<size_t>(depth_), ' ');
}

void JsonWriter::separate() {
  if (after_key_) {
    after_key_ = false;
    return;
  }
  if (!first_) text_ += ',';
  if (depth_ > 0) newline();
  first_ = false;
}

void JsonWriter::open(char bracket) {
  separate();
  text_ += bracket;
  ++depth_;
  first_ = true;
}

void JsonWriter::close(char bracket) {
  --depth_;
  if (!first_) newline();
  text_ += bracket;
  first_ = false;
}

void JsonWriter::key(std::string_view name) {
  separate();
  text_ += '"' + json_escaped(name) + "\": ";
  after_key_ = true;
}

void JsonWriter::raw(std::string_view token) {
  separate();
  text_ += token;
}

void JsonWriter::value(std::string_view text) {
  raw('"' + json_escaped(text) + '"');
}

void JsonWriter::value(double number) {
  if (!std::isfinite(number)) return null();
  char digits[32];
  const auto end = std::to_chars(digits, digits + sizeof digits, number).ptr;
  raw(std::string_view(digits, static_cast<size_t>(end - digits)));
}

void JsonWriter::fixed(double number, int digits) {
  if (!std::isfinite(number) || std::fabs(number) > 1e15) return value(number);
  char text[64];
  const auto end = std::to_chars(text, text + sizeof text, number, std::chars_format::fixed, digits).ptr;
  raw(std::string_view(text, static_cast<size_t>(end - text)));
}

void JsonWriter::value(int64_t number) {
  raw(std::to_string(number));
}

void JsonWriter::value(uint64_t number) {
  raw(std::to_string(number));
}

}  // namespace pac::sim
