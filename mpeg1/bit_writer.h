// Bits in memory, first bit first: a growing writer that stores 64 at a time, and can append another's bits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

namespace pac::mpeg1 {

class FastBitWriter {
 public:
  void clear() {
    size_ = 0;
    window_ = 0;
    n_bits_ = 0;
  }
  // The low `count` bits of value, 0..32; higher bits of value are zero.
  void put(uint32_t value, int count) {
    n_bits_ += count;
    if (n_bits_ <= 64) {
      if (count != 0) window_ |= static_cast<uint64_t>(value) << (64 - n_bits_);
      return;
    }
    const int rest = n_bits_ - 64;  // 1..31 bits for the next window
    store(window_ | static_cast<uint64_t>(value) >> rest);
    window_ = static_cast<uint64_t>(value) << (64 - rest);
    n_bits_ = rest;
  }

  // Writes in its stead for a while, for whoever keeps it in registers: nobody takes its address. Of at most
  // `most_bits` bits; the writer rests until take_back().
  class Loan {
   public:
    // The low `count` bits of value, 1..56; higher bits of value are zero. Stores every time: no branch to mispredict.
    void put(uint64_t value, int count) {
      n_bits_ += count;
      window_ |= value << (64 - n_bits_);
      write64(next_, window_);
      next_ += n_bits_ >> 3;
      window_ <<= n_bits_ & ~7;  // less than 64
      n_bits_ &= 7;
    }

   private:
    friend class FastBitWriter;
    Loan(uint8_t* next, uint64_t window, int n_bits) : next_(next), window_(window), n_bits_(n_bits) {}
    uint8_t* next_;
    uint64_t window_;
    int n_bits_;  // 0..7
  };
  Loan lend(size_t most_bits) {
    const size_t most_bytes = most_bits / 8 + 16;
    if (size_ + most_bytes > bytes_.size()) bytes_.resize(2 * bytes_.size() + most_bytes + 4096);
    uint8_t* const at = bytes_.data() + size_;
    write64(at, window_);
    return {at + (n_bits_ >> 3), n_bits_ == 64 ? 0 : window_ << (n_bits_ & ~7), n_bits_ & 7};
  }
  void take_back(const Loan& loan) {
    size_ = static_cast<size_t>(loan.next_ - bytes_.data());
    window_ = loan.window_;
    n_bits_ = loan.n_bits_;
  }

  void align_to_byte() { n_bits_ = (n_bits_ + 7) & ~7; }
  uint64_t size_bits() const { return uint64_t{8} * size_ + static_cast<uint64_t>(n_bits_); }

  // All of them, of which there are at most 32, right-aligned.
  uint32_t value() const { return n_bits_ == 0 ? 0 : static_cast<uint32_t>(window_ >> (64 - n_bits_)); }

  // All bits of `other` after ours.
  void append(const FastBitWriter& other) {
    size_t at = 0;
    for (; at + 4 <= other.size_; at += 4) put(load32(other.bytes_.data() + at), 32);
    for (; at < other.size_; ++at) put(other.bytes_[at], 8);
    uint64_t window = other.window_;
    for (int left = other.n_bits_; left > 0; left -= 32) {
      const int count = left < 32 ? left : 32;
      put(static_cast<uint32_t>(window >> 32) >> (32 - count), count);
      window <<= 32;
    }
  }
  // Appends the bytes, the last one filled with zeros, to `out`. Leaves the writer as it is.
  void append_to(std::vector<uint8_t>& out) const {
    out.insert(out.end(), bytes_.begin(), bytes_.begin() + static_cast<ptrdiff_t>(size_));
    for (int i = 0; i < n_bits_; i += 8) out.push_back(static_cast<uint8_t>(window_ >> (56 - i)));
  }

 private:
  static uint32_t load32(const uint8_t* p) {
    return static_cast<uint32_t>(p[0]) << 24 | static_cast<uint32_t>(p[1]) << 16 | static_cast<uint32_t>(p[2]) << 8 |
           p[3];
  }
  static void write64(uint8_t* p, uint64_t bits) {
    uint8_t bytes[8];  // of their own, so that they become one store
    for (int i = 0; i < 8; ++i) bytes[i] = static_cast<uint8_t>(bits >> (56 - 8 * i));
    std::memcpy(p, bytes, 8);
  }
  void store(uint64_t bits) {
    if (size_ + 8 > bytes_.size()) bytes_.resize(2 * bytes_.size() + 4096);
    write64(bytes_.data() + size_, bits);
    size_ += 8;
  }

  std::vector<uint8_t> bytes_;  // size_ of them are written
  size_t size_ = 0;
  uint64_t window_ = 0;  // n_bits_ (0..64) from the top down
  int n_bits_ = 0;
};

}  // namespace pac::mpeg1
