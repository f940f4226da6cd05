// Semi-static coding for meshes whose speed counts: an encoder notes symbols of 16 values with their contexts, then
// writes one table of frequencies per context and the symbols by rANS [Duda 2013, "Asymmetric numeral systems"], four
// states side by side. Bits that are as good as random lie backwards from the section's end as in range_coder.h, with
// whose classes these share the member functions that templates call. FORMAT.md section 15.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "geomcodec/expected_tables.h"
#include "geomcodec/symbol_model.h"

namespace pac::geomcodec {

inline constexpr uint32_t kLowestState = 1u << 16;
inline constexpr size_t kLanes = 4, kMaxTableContexts = 1024;
// Lanes whose states are told; the others are not used.
inline size_t lanes_of(Expected expected) {
  return expected == Expected::faces ? 1 : kLanes;
}
using SymbolCounts = std::array<uint32_t, kTableSymbols>;

class TableEncoder {
 public:
  static constexpr bool kDecodes = false, kTables = true;

  // expected: what contexts have that are told no table.
  TableEncoder(size_t n_contexts, Expected expected) : n_contexts_(n_contexts), expected_(expected) {}
  void reserve(size_t n_symbols) { noted_.reserve(n_symbols); }
  // symbol below 16 in a context below n_contexts, on one of four lanes.
  uint32_t symbol(uint32_t lane, uint32_t context, uint32_t symbol) {
    noted_.push_back(static_cast<uint16_t>(context << 6 | symbol << 2 | lane));
    return symbol;
  }
  uint32_t raw(int count, uint32_t value) {
    raw_word_ |= uint64_t{value & ((1u << count) - 1)} << raw_count_;
    raw_count_ += count;
    if (raw_count_ >= 48) flush_raw();
    return value;
  }
  bool failed() const { return false; }
  std::vector<SymbolCounts> counts() const;  // by context, so far
  // The section's bytes. Leaves the encoder unusable.
  std::vector<uint8_t> finish();

 private:
  void flush_raw() {
    for (; raw_count_ >= 8; raw_count_ -= 8, raw_word_ >>= 8) raw_bytes_.push_back(static_cast<uint8_t>(raw_word_));
  }

  size_t n_contexts_;
  Expected expected_;
  std::vector<uint16_t> noted_;
  std::vector<uint8_t> raw_bytes_;  // the section's last byte first
  uint64_t raw_word_ = 0;
  int raw_count_ = 0;
};

// Tables made for looking symbols up.
class SymbolTables {
 public:
  // Reads what TableEncoder::finish() begins with; the number of bytes, 0 if they cannot come from it.
  size_t parse(std::span<const uint8_t> bytes, size_t n_contexts, Expected expected);

  // [context], where they lie until the next parse().
  const LookupTable* const* of_context() const { return of_context_.data(); }

 private:
  std::vector<const LookupTable*> of_context_;
  std::unique_ptr<LookupTable[]> told_;
};

// Sticky: past the end it reads the section's last bytes again; failed() tells once it did.
class TableDecoder {
 public:
  static constexpr bool kDecodes = true, kTables = true;

  // tables must outlive the decoder, bytes too.
  TableDecoder(std::span<const uint8_t> bytes, size_t n_contexts, Expected expected, SymbolTables& tables);

  [[gnu::always_inline]] uint32_t symbol(uint32_t lane, uint32_t context, uint32_t /*unused*/ = 0) {
    const uint32_t state = state_[lane], slot = state & (kTableTotal - 1);
    const LookupTable& table = *of_context_[context];
    const uint32_t symbol = table.symbol[slot];
    const FrequencyTable::Entry entry = table.entry[symbol];
    const uint32_t next = entry.freq * (state >> kTableBits) + slot - entry.start;
    const uint8_t* at = data_ + (position_ < size_ - 2 ? position_ : size_ - 2);
    const uint32_t word = uint32_t{at[0]} | uint32_t{at[1]} << 8;
    const bool low = next < kLowestState;
    state_[lane] = low ? next << 16 | word : next;
    position_ += low ? 2 : 0;
    return symbol;
  }
  uint32_t raw(int count, uint32_t /*unused*/ = 0) {
    const uint64_t whole = raw_used_ >> 3;
    if (size_ < whole + 4) return raw_at_start(count);
    const uint8_t* at = data_ + (size_ - whole - 4);
    const uint32_t word = uint32_t{at[0]} << 24 | uint32_t{at[1]} << 16 | uint32_t{at[2]} << 8 | at[3];
    const uint32_t value = word >> (raw_used_ & 7) & ((1u << count) - 1);
    raw_used_ += static_cast<uint32_t>(count);
    return value;
  }
  bool failed() const { return position_ + (raw_used_ + 7) / 8 > size_; }
  // Everything was read and nothing else, and all lanes are where an encoder starts them.
  bool ends_exactly() const {
    bool at_start = position_ + (raw_used_ + 7) / 8 == size_;
    for (const uint32_t state : state_) at_start = at_start && state == kLowestState;
    return at_start;
  }

 private:
  uint32_t raw_at_start(int count);

  const LookupTable* const* of_context_;
  const uint8_t* data_;
  uint64_t size_;
  uint64_t position_ = 0;
  uint64_t raw_used_ = 0;
  uint32_t state_[kLanes];
};

inline void release(TableDecoder& coder, const TableDecoder& held) {
  coder = held;
}
inline void release(TableEncoder& /*coder*/, const TableEncoder& /*held*/) {}

// The magnitude class of a residual within -2^15 .. 2^15 as a symbol; 15 stands for 15 and 16.
template <class Coder>
[[gnu::always_inline]] inline uint32_t code_table_class(Coder& coder, uint32_t lane, uint32_t context,
                                                        int32_t residual) {
  uint32_t length = 0;
  if constexpr (!Coder::kDecodes) length = class_of(residual);
  return coder.symbol(lane, context, length < 15 ? length : 15);
}

// What the symbol leaves open: the sign, then the bits below the leading one, as one field. Without branches on it but
// for the rare 15: a symbol is as good as random. Returns the residual's class.
template <class Coder>
[[gnu::always_inline]] inline uint32_t code_table_details(Coder& coder, uint32_t symbol, int32_t& residual) {
  uint32_t length = symbol;
  if (symbol == 15) {
    uint32_t longer = 0;
    if constexpr (!Coder::kDecodes) longer = class_of(residual) - 15;
    length += coder.raw(1, longer);
  }
  const uint32_t leading = (1u << length) >> 1;
  if constexpr (Coder::kDecodes) {
    const uint32_t field = coder.raw(static_cast<int>(length));
    const auto magnitude = static_cast<int32_t>(leading | (field & (leading - 1)));
    const int32_t negative = -static_cast<int32_t>((field & leading) != 0);
    residual = (magnitude ^ negative) - negative;
  } else if (length > 0) {
    const auto magnitude = static_cast<uint32_t>(residual < 0 ? -residual : residual);
    coder.raw(static_cast<int>(length), (residual < 0 ? leading : 0) | (magnitude & (leading - 1)));
  }
  return length;
}

// A residual within -2^15 .. 2^15: its magnitude class as a symbol, the rest raw.
template <class Coder>
[[gnu::always_inline]] inline int32_t code_table_residual(Coder& coder, uint32_t lane, uint32_t context,
                                                          int32_t residual = 0) {
  code_table_details(coder, code_table_class(coder, lane, context, residual), residual);
  return residual;
}

}  // namespace pac::geomcodec
