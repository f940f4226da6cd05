#include "raster/load_text.h"

#include <cmath>

namespace pac::raster {
namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\v' || c == '\f' || c == '\r';
}
bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

// mantissa * 10^exponent. 10^22 is the highest power of ten that a double holds exactly: two steps suffice up to 10^44,
// and floats end at 10^39; what lies beyond saturates.
double scaled(uint64_t mantissa, int64_t exponent) {
  constexpr double kPower[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                               1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
  auto value = static_cast<double>(mantissa);
  if (mantissa == 0) return 0;
  if (exponent > 60) return 1e300;  // at least 10^61
  if (exponent < -100) return 0;    // below 10^-81
  for (; exponent > 22; exponent -= 22) value *= kPower[22];
  for (; exponent < -22; exponent += 22) value /= kPower[22];
  return exponent >= 0 ? value * kPower[exponent] : value / kPower[-exponent];
}

bool equal_ignoring_case(std::string_view word, std::string_view lower) {
  if (word.size() != lower.size()) return false;
  for (size_t i = 0; i < word.size(); ++i)
    if ((word[i] | 0x20) != lower[i]) return false;
  return true;
}

}  // namespace

std::string_view LineReader::physical_line() {
  const size_t begin = at_;
  while (at_ < bytes_.size() && bytes_[at_] != '\n' && bytes_[at_] != '\r') ++at_;
  const std::string_view line(reinterpret_cast<const char*>(bytes_.data()) + begin, at_ - begin);
  if (at_ < bytes_.size() && bytes_[at_++] == '\r' && at_ < bytes_.size() && bytes_[at_] == '\n') ++at_;
  return line;
}

bool LineReader::next() {
  if (at_ >= bytes_.size()) return false;
  offset_ = at_;
  line_ = physical_line();
  if (!joins_ || line_.empty() || line_.back() != '\\' || trimmed(line_).front() == '#') return true;
  joined_.clear();
  std::string_view part = line_;
  while (!part.empty() && part.back() == '\\') {
    joined_.append(part.substr(0, part.size() - 1));
    joined_.push_back(' ');
    part = at_ < bytes_.size() ? physical_line() : std::string_view();
  }
  joined_.append(part);
  line_ = joined_;
  return true;
}

size_t byte_order_mark_size(std::span<const uint8_t> bytes) {
  return bytes.size() >= 3 && bytes[0] == 0xEF && bytes[1] == 0xBB && bytes[2] == 0xBF ? 3 : 0;
}

bool is_wide_text(std::span<const uint8_t> bytes) {
  if (bytes.size() < 2) return false;
  if ((bytes[0] == 0xFE && bytes[1] == 0xFF) || (bytes[0] == 0xFF && bytes[1] == 0xFE)) return true;
  for (size_t i = 0; i < bytes.size() && i < 4; ++i)
    if (bytes[i] == 0) return true;
  return false;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::string_view take_word(std::string_view& text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  size_t size = 0;
  while (size < text.size() && !is_blank(text[size])) ++size;
  const std::string_view word = text.substr(0, size);
  text.remove_prefix(size);
  return word;
}

std::string_view without_comment(std::string_view text) {
  for (size_t i = 0; i < text.size(); ++i)
    if (text[i] == '#' && (i == 0 || is_blank(text[i - 1]))) return text.substr(0, i);
  return text;
}

NumberKind parse_float(std::string_view word, float& value) {
  value = 0;
  size_t i = 0;
  const bool negative = !word.empty() && word[0] == '-';
  if (!word.empty() && (word[0] == '-' || word[0] == '+')) ++i;
  const std::string_view rest = word.substr(i);
  for (const char* name : {"nan", "inf", "infinity", "nan(ind)", "nan(snan)"})
    if (equal_ignoring_case(rest, name)) return NumberKind::not_finite;
  if (rest.starts_with("1.#")) return NumberKind::not_finite;  // as old Microsoft libraries print them

  uint64_t mantissa = 0;
  int64_t exponent = 0;
  int n_digits = 0, n_significant = 0;
  bool after_point = false;
  for (; i < word.size(); ++i) {
    if (word[i] == '.' && !after_point) {
      after_point = true;
      continue;
    }
    if (!is_digit(word[i])) break;
    ++n_digits;
    if (n_significant < 19) {
      mantissa = mantissa * 10 + static_cast<uint64_t>(word[i] - '0');
      if (mantissa != 0) ++n_significant;
      if (after_point) --exponent;
    } else if (!after_point) {
      ++exponent;
    }
  }
  if (n_digits == 0) return NumberKind::malformed;
  // "3.1+e2": the number ends before the sign, as strtod and other OBJ readers have it.
  if (i + 1 < word.size() && (word[i] == '+' || word[i] == '-') && (word[i + 1] == 'e' || word[i + 1] == 'E')) {
    int64_t ignored = 0;
    if (!parse_integer(word.substr(i + 2), ignored)) return NumberKind::malformed;
    word = word.substr(0, i);
  }
  if (i < word.size()) {
    int64_t written = 0;
    if ((word[i] != 'e' && word[i] != 'E') || !parse_integer(word.substr(i + 1), written)) return NumberKind::malformed;
    exponent += written;
  }
  const auto rounded = static_cast<float>(scaled(mantissa, exponent));
  if (!std::isfinite(rounded)) return NumberKind::not_finite;
  value = negative ? -rounded : rounded;
  return NumberKind::finite;
}

bool parse_integer(std::string_view word, int64_t& value) {
  constexpr int64_t kLargest = int64_t{1} << 62;
  const bool negative = !word.empty() && word[0] == '-';
  if (!word.empty() && (word[0] == '-' || word[0] == '+')) word.remove_prefix(1);
  if (word.empty()) return false;
  int64_t magnitude = 0;
  for (const char c : word) {
    if (!is_digit(c)) return false;
    magnitude = magnitude > kLargest / 10 - 10 ? kLargest : magnitude * 10 + (c - '0');
  }
  value = negative ? -magnitude : magnitude;
  return true;
}

}  // namespace pac::raster
