// Bits in memory, most significant bit first: a sticky reader and a growing writer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "base/result.h"

namespace pac {

// Reads bits from the top of each byte downwards. Past the end it delivers zeros and remembers it (sticky): decoders
// check overrun() once per row of blocks and at the end, not at each read. Keeps a pointer to the caller's bytes.
class BitReader {
 public:
  BitReader() = default;
  explicit BitReader(std::span<const uint8_t> bytes) : bytes_(bytes) {}

  // The next `count` bits (0..32) without consuming them.
  uint32_t peek(int count) const {
    if (count == 0) return 0;
    const size_t byte = static_cast<size_t>(position_ >> 3);
    uint64_t window = 0;
    for (size_t i = 0; i < 5; ++i) window = window << 8 | (byte + i < bytes_.size() ? bytes_[byte + i] : 0u);
    const int shift = 40 - static_cast<int>(position_ & 7) - count;
    return static_cast<uint32_t>(window >> shift & ((uint64_t{1} << count) - 1));
  }
  void skip(int count) { position_ += static_cast<uint64_t>(count); }
  uint32_t read(int count) {
    const uint32_t value = peek(count);
    skip(count);
    return value;
  }
  bool read_flag() { return read(1) != 0; }
  void align_to_byte() { position_ = (position_ + 7) & ~uint64_t{7}; }

  bool overrun() const { return position_ > uint64_t{8} * bytes_.size(); }
  uint64_t position_bits() const { return position_; }
  uint64_t byte_offset() const { return position_ >> 3; }
  uint64_t remaining_bits() const { return overrun() ? 0 : uint64_t{8} * bytes_.size() - position_; }

 private:
  std::span<const uint8_t> bytes_;
  uint64_t position_ = 0;  // in bits from the first byte
};

// Appends bits to a byte vector that it owns until take().
class BitWriter {
 public:
  // Appends the low `count` bits (0..32) of `value`, most significant first. Higher bits of value are ignored.
  void put(uint32_t value, int count) {
    pending_ = pending_ << count | (value & ((uint64_t{1} << count) - 1));
    n_pending_ += count;
    while (n_pending_ >= 8) {
      n_pending_ -= 8;
      bytes_.push_back(static_cast<uint8_t>(pending_ >> n_pending_));
    }
  }
  // Fills up the last byte with `bit` (0 or 1).
  void align_to_byte(int bit = 0) {
    const int n = (8 - n_pending_) & 7;
    put(bit != 0 ? 0xFFu : 0u, n);
  }
  uint64_t size_bits() const { return uint64_t{8} * bytes_.size() + static_cast<uint64_t>(n_pending_); }
  // The bytes written; the last one filled with zeros. Leaves the writer empty.
  std::vector<uint8_t> take() {
    align_to_byte();
    pending_ = 0;
    n_pending_ = 0;
    return std::exchange(bytes_, {});
  }

 private:
  std::vector<uint8_t> bytes_;
  uint64_t pending_ = 0;  // low n_pending_ bits wait; n_pending_ < 8 between calls
  int n_pending_ = 0;
};

}  // namespace pac
