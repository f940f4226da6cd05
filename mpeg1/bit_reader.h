// Bits of one unit of the stream, first bit first, through a 64-bit window. Sticky: past the end it delivers zeros.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace pac::mpeg1 {

// refill() makes at least 56 bits available; peek and skip then move within them without looking. Keeps a pointer to
// the bytes.
class UnitReader {
 public:
  UnitReader() = default;
  explicit UnitReader(std::span<const uint8_t> bytes)
      : begin_(bytes.data()), next_(bytes.data()), end_(bytes.data() + bytes.size()) {
    refill();
  }

  void refill() {
    if (end_ - next_ >= 8) {
      uint64_t bytes;
      std::memcpy(&bytes, next_, 8);
      if constexpr (kIsLittleEndian) bytes = __builtin_bswap64(bytes);
      window_ |= bytes >> n_bits_;
      next_ += (63 - n_bits_) >> 3;
      n_bits_ |= 56;  // n_bits_ + 8 * ((63 - n_bits_) / 8)
    } else {
      *this = refilled_at_end(*this);
    }
  }
  // The next `count` bits, 1..32; refill() guarantees 56.
  uint32_t peek(int count) const { return static_cast<uint32_t>(window_ >> (64 - count)); }
  void skip(int count) {
    window_ <<= count;
    n_bits_ -= count;
  }
  // A leading 1 is read twice; at most 63 bits available before.
  void double_leading_one() {
    const uint64_t one = window_ >> 63;
    window_ = one << 63 | window_ >> one;
    n_bits_ += static_cast<int>(one);
  }
  int available() const { return n_bits_; }
  // With its own refill: for headers.
  uint32_t read(int count) {
    if (count == 0) return 0;
    refill();
    const uint32_t value = peek(count);
    skip(count);
    return value;
  }

  // Bits consumed so far.
  int64_t position_bits() const { return 8 * (next_ - begin_) + 8 * n_zero_bytes_ - n_bits_; }
  bool overrun() const { return 8 * n_zero_bytes_ > n_bits_; }
  // Nothing but zeros is left: where a slice ends [2.4.2.6]. True past the end too.
  bool only_zeros_left() {
    refill();
    if (window_ >> 41 != 0) return false;  // 23 zero bits cannot begin a macroblock
    return true;
  }

 private:
#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
  static constexpr bool kIsLittleEndian = false;
#else
  static constexpr bool kIsLittleEndian = true;
#endif

  // Out of line and by value: a reader whose address nobody takes lives in registers.
  static UnitReader refilled_at_end(UnitReader reader);

  const uint8_t* begin_ = nullptr;
  const uint8_t* next_ = nullptr;  // the next byte that is not in the window as a whole
  const uint8_t* end_ = nullptr;
  uint64_t window_ = 0;       // the next bits from the top down; below n_bits_ of them, bits of *next_
  int64_t n_zero_bytes_ = 0;  // delivered past the end
  int n_bits_ = 0;
};

inline __attribute__((noinline)) UnitReader UnitReader::refilled_at_end(UnitReader reader) {
  while (reader.n_bits_ <= 55) {
    uint64_t byte = 0;
    if (reader.next_ != reader.end_)
      byte = *reader.next_++;
    else
      ++reader.n_zero_bytes_;
    reader.window_ |= byte << (56 - reader.n_bits_);
    reader.n_bits_ += 8;
  }
  return reader;
}

}  // namespace pac::mpeg1
