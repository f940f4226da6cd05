// Numbers in headers: fixed width, variable length, checked on the way in. FORMAT.md section 1.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"
#include "geomcodec/container.h"

namespace pac::geomcodec {

inline void put_varint(std::vector<uint8_t>& out, uint32_t value) {
  for (; value >= 0x80; value >>= 7) out.push_back(static_cast<uint8_t>(value | 0x80));
  out.push_back(static_cast<uint8_t>(value));
}
inline void put_u32(std::vector<uint8_t>& out, uint32_t value) {
  for (int shift = 0; shift < 32; shift += 8) out.push_back(static_cast<uint8_t>(value >> shift));
}

inline void put_float(std::vector<uint8_t>& out, float value) {
  put_u32(out, std::bit_cast<uint32_t>(value));
}

// Ends a header: CRC-32 of it and of the sections, then these. Returns the bytes of the header.
uint64_t put_sections(std::vector<uint8_t>& out, std::span<const std::vector<uint8_t>> sections);

// Sticky: past the end, or at a number that is too long, it delivers zeros and remembers where.
class ByteReader {
 public:
  explicit ByteReader(std::span<const uint8_t> bytes) : bytes_(bytes) {}
  uint8_t u8() {
    if (position_ >= bytes_.size()) return fail(Error::truncated, "header ends too early"), uint8_t{0};
    return bytes_[position_++];
  }
  uint32_t u32() {
    uint32_t value = 0;
    for (int shift = 0; shift < 32; shift += 8) value |= uint32_t{u8()} << shift;
    return value;
  }
  uint32_t varint() {
    uint64_t value = 0;
    for (int shift = 0; shift < 35; shift += 7) {
      const uint8_t byte = u8();
      value |= uint64_t{byte & 0x7Fu} << shift;
      if (byte >= 0x80) continue;
      if (value > 0xFFFFFFFFu || (byte == 0 && shift > 0)) break;
      return static_cast<uint32_t>(value);
    }
    fail(Error::corrupt, "malformed number in the header");
    return 0;
  }
  uint32_t count() {
    const uint32_t value = varint();
    if (value > kMaxCount) fail(Error::corrupt, "count in the header is too large");
    return value;
  }
  void fail(Error error, const char* text) {
    if (ok_) failure_ = {error, position_, text};
    ok_ = false;
  }
  bool ok() const { return ok_; }
  const Failure& failure() const { return failure_; }
  uint64_t position() const { return position_; }

 private:
  std::span<const uint8_t> bytes_;
  size_t position_ = 0;
  bool ok_ = true;
  Failure failure_;
};

}  // namespace pac::geomcodec
