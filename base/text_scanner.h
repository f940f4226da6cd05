// Reads the text headers of PNM, PFM and Y4M files: sticky, with the offset of the first fault.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/result.h"

namespace pac {

// A cursor over bytes. The first failure stays; afterwards every read gives 0 and moves nothing.
class TextScanner {
 public:
  explicit TextScanner(std::span<const uint8_t> bytes, size_t at = 0) : bytes_(bytes), at_(at) {}

  static bool is_space(int c) { return c == ' ' || (c >= '\t' && c <= '\r'); }
  static bool is_digit(int c) { return c >= '0' && c <= '9'; }

  size_t offset() const { return at_; }
  bool ok() const { return ok_; }
  const Failure& failure() const { return failure_; }
  bool at_end() const { return at_ >= bytes_.size(); }
  // The next byte, or -1 at the end and after a failure: a loop that reads while peek() fits always ends.
  int peek() const { return !ok_ || at_end() ? -1 : bytes_[at_]; }
  int next() {
    const int c = peek();
    if (c >= 0 && ok_) ++at_;
    return c;
  }

  // Records a failure at the current byte, once.
  void fail(Error error, const char* text) {
    if (ok_) failure_ = {error, at_, text};
    ok_ = false;
  }
  // Wrong byte: truncated where it is the end, else corrupt.
  void fail_here(const char* text) { fail(at_end() ? Error::truncated : Error::corrupt, text); }

  // Skips white space and, where `comments`, everything from '#' to the end of the line.
  void skip_space(bool comments) {
    while (ok_ && !at_end()) {
      if (is_space(peek())) {
        ++at_;
      } else if (comments && peek() == '#') {
        while (!at_end() && peek() != '\n' && peek() != '\r') ++at_;
      } else {
        return;
      }
    }
  }

  // A decimal number 0..max; anything else fails with `text`.
  uint32_t read_number(uint32_t max, const char* text) {
    if (!is_digit(peek())) fail_here(text);
    const size_t start = at_;
    uint64_t value = 0;
    while (ok_ && is_digit(peek())) {
      value = value * 10 + static_cast<uint64_t>(next() - '0');
      if (value > max) {
        at_ = start;
        fail(Error::corrupt, text);
      }
    }
    return ok_ ? static_cast<uint32_t>(value) : 0;
  }

  // Exactly this byte.
  void expect(char c, const char* text) {
    if (peek() != c) {
      fail_here(text);
    } else {
      next();
    }
  }
  // One byte of white space.
  void expect_space(const char* text) {
    if (!is_space(peek())) {
      fail_here(text);
    } else {
      next();
    }
  }

 private:
  std::span<const uint8_t> bytes_;
  size_t at_ = 0;
  bool ok_ = true;
  Failure failure_;
};

}  // namespace pac
