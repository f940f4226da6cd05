#include "geomcodec/range_coder.h"

namespace pac::geomcodec {

// low_ passed 2^64: one more in the bytes already written. The coded number is below 1, so a byte below 0xFF exists.
void RangeEncoder::carry() {
  size_t i = bytes_.size();
  while (i > 0 && ++bytes_[i - 1] == 0) --i;
}

void RangeEncoder::emit_word() {
  for (int shift = 56; shift >= 32; shift -= 8) bytes_.push_back(static_cast<uint8_t>(low_ >> shift));
  low_ <<= 32;
  range_ <<= 32;
}

void RangeEncoder::flush_raw() {
  for (; raw_count_ >= 8; raw_count_ -= 8, raw_word_ >>= 8) raw_bytes_.push_back(static_cast<uint8_t>(raw_word_));
}

std::vector<uint8_t> RangeEncoder::finish() {
  flush_raw();
  if (raw_count_ > 0) raw_bytes_.push_back(static_cast<uint8_t>(raw_word_));
  // The number with the fewest bytes in [low_, low_ + range_), whatever follows: zeros if there are no raw bits, else
  // they do, and all that the decoder could read must lie below the end.
  for (int n_bytes = 0; n_bytes <= 8; ++n_bytes) {
    const uint64_t below = n_bytes == 0 ? ~uint64_t{0} : (uint64_t{1} << (64 - 8 * n_bytes) % 64) - 1;
    const uint64_t mask = n_bytes == 8 ? 0 : below;
    const uint64_t number = (low_ + mask) & ~mask;  // may wrap to 2^64 + ...: the distance from low_ still holds
    if (number - low_ >= range_) continue;
    if (!raw_bytes_.empty() && range_ - (number - low_) <= mask) continue;
    if (number < low_) carry();
    for (int i = 0; i < n_bytes; ++i) bytes_.push_back(static_cast<uint8_t>(number >> (56 - 8 * i)));
    break;
  }
  bytes_.insert(bytes_.end(), raw_bytes_.rbegin(), raw_bytes_.rend());
  return std::exchange(bytes_, {});
}

uint32_t RangeDecoder::last_word(const uint8_t* data, uint64_t size, uint64_t at) {
  uint32_t word = 0;
  for (uint64_t i = at; i < at + 4; ++i) word = word << 8 | (i < size ? data[i] : 0u);
  return word;
}

uint32_t RangeDecoder::first_word(const uint8_t* data, uint64_t size, uint64_t after) {
  uint32_t word = 0;
  for (uint64_t back = after + 4; back > after; --back) word = word << 8 | (back <= size ? data[size - back] : 0u);
  return word;
}

}  // namespace pac::geomcodec
