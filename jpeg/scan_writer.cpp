#include "jpeg/scan_writer.h"

#include <bit>
#include <cstring>

#include "jpeg/tables.h"

namespace pac::jpeg {
namespace {

// SSSS, the category of a value [T.81 tables F.1, F.2]: bits of its magnitude; and its extra bits, the value itself or,
// if negative, its one's complement's low bits.
Token with_value(uint32_t table, int run, int value) {
  const auto magnitude = static_cast<uint32_t>(value < 0 ? -value : value);
  const auto size = static_cast<uint32_t>(std::bit_width(magnitude));
  const uint32_t bits = static_cast<uint32_t>(value < 0 ? value - 1 : value) & ((1u << size) - 1);
  return table << 24 | static_cast<uint32_t>(run) << 20 | size << 16 | bits;
}

}  // namespace

Token* tokenize_block(const int16_t* levels, uint64_t nonzero, int dc_difference, uint32_t dc_table, Token* out) {
  const uint32_t ac_table = dc_table + 1;
  *out++ = with_value(dc_table, 0, dc_difference);
  int previous = 0;
  for (uint64_t rest = nonzero & ~uint64_t{1}; rest != 0; rest &= rest - 1) {
    const int k = std::countr_zero(rest);
    int run = k - previous - 1;
    for (; run > 15; run -= 16) *out++ = ac_table << 24 | 0xF0u << 16;  // ZRL
    *out++ = with_value(ac_table, run, levels[k]);
    previous = k;
  }
  if (previous != 63) *out++ = ac_table << 24;  // EOB
  return out;
}

void add_to_histogram(const Token* begin, const Token* end, Histogram& histogram) {
  uint64_t* counts = histogram.count[0];
  for (const Token* token = begin; token != end; ++token)
    if ((*token & kRestartToken) == 0) counts[*token >> 16] += 1;
}

ScanTables standard_tables() {
  return {{standard_dc(0), standard_ac(0), standard_dc(1), standard_ac(1)}};
}

ScanTables optimal_tables(const Histogram& histogram) {
  ScanTables tables;
  for (int i = 0; i < kTableCount; ++i) tables.spec[i] = optimal_huffman(histogram.count[i]);
  return tables;
}

void ScanWriter::set_tables(const ScanTables& tables) {
  for (size_t i = 0; i < kTableCount; ++i) {
    HuffmanCodes codes;
    make_codes(tables.spec[i], codes);
    std::memcpy(code_and_length_ + 256 * i, codes.code_and_length, sizeof codes.code_and_length);
  }
}

// count <= 32 and at most 7 + 32 bits are pending: whole bytes leave at once.
void ScanWriter::put(uint32_t bits, int count) {
  pending_ = pending_ << count | bits;
  n_pending_ += count;
  if (n_pending_ < 32) return;
  n_pending_ -= 32;
  const auto word = static_cast<uint32_t>(pending_ >> n_pending_);
  // No byte of the word is 0xFF if no byte of its complement is zero.
  const uint32_t complement = ~word;
  if (((complement - 0x01010101u) & word & 0x80808080u) == 0) {
    for (int i = 0; i < 4; ++i) chunk_[n_chunk_ + static_cast<size_t>(i)] = static_cast<uint8_t>(word >> (24 - 8 * i));
    n_chunk_ += 4;
  } else {
    for (int shift = 24; shift >= 0; shift -= 8) {
      const auto byte = static_cast<uint8_t>(word >> shift);
      chunk_[n_chunk_++] = byte;
      if (byte == 0xFF) chunk_[n_chunk_++] = 0;
    }
  }
  if (n_chunk_ > kChunk) flush_chunk();
}

void ScanWriter::flush_to_byte() {
  const int fill = -n_pending_ & 7;
  uint64_t bits = pending_ << fill | ((1u << fill) - 1);
  for (int left = n_pending_ + fill; left > 0; left -= 8) {
    const auto byte = static_cast<uint8_t>(bits >> (left - 8));
    chunk_[n_chunk_++] = byte;
    if (byte == 0xFF) chunk_[n_chunk_++] = 0;
  }
  pending_ = 0;
  n_pending_ = 0;
}

void ScanWriter::flush_chunk() {
  sink_.append({chunk_, n_chunk_});
  n_chunk_ = 0;
}

void ScanWriter::write(const Token* begin, const Token* end) {
  for (const Token* token = begin; token != end; ++token) {
    if ((*token & kRestartToken) != 0) {
      flush_to_byte();
      chunk_[n_chunk_++] = 0xFF;
      chunk_[n_chunk_++] = static_cast<uint8_t>(0xD0 | (*token & 7));
      if (n_chunk_ > kChunk) flush_chunk();
      continue;
    }
    const uint32_t entry = code_and_length_[*token >> 16];
    const int size = static_cast<int>(*token >> 16 & 15);
    put((entry >> 8) << size | (*token & 0xFFFF), static_cast<int>(entry & 255) + size);
  }
}

void ScanWriter::finish() {
  flush_to_byte();
  flush_chunk();
}

}  // namespace pac::jpeg
