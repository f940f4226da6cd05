#include "jpeg/scan_writer.h"

#include <bit>
#include <cstring>

#include "jpeg/tables.h"

namespace pac::jpeg {
namespace {

// SSSS, the category of a value [T.81 tables F.1, F.2]: bits of its magnitude; and its extra bits, the value itself or,
// if negative, its one's complement's low bits. Without branches: signs are random.
Token with_value(uint32_t table_and_run, int value) {
  const int sign = value >> 31;
  const auto magnitude = static_cast<uint32_t>((value ^ sign) - sign);
  const auto size = static_cast<uint32_t>(std::bit_width(magnitude));
  const uint32_t bits = static_cast<uint32_t>(value + sign) & ((1u << size) - 1);
  return table_and_run | size << 16 | bits;
}

}  // namespace

Token* tokenize_block(const int16_t* levels, uint64_t nonzero, int dc_difference, uint32_t dc_table, Token* out) {
  const uint32_t ac_table = (dc_table + 1) << 24;
  *out++ = with_value(dc_table << 24, dc_difference);
  int previous = 0;
  for (uint64_t rest = nonzero & ~uint64_t{1}; rest != 0; rest &= rest - 1) {
    const int k = std::countr_zero(rest);
    int run = k - previous - 1;
    for (; run > 15; run -= 16) *out++ = ac_table | 0xF0u << 16;  // ZRL
    *out++ = with_value(ac_table | static_cast<uint32_t>(run) << 20, levels[k]);
    previous = k;
  }
  if (previous != 63) *out++ = ac_table;  // EOB
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
  bits_.out = chunk_;
  for (size_t i = 0; i < kTableCount; ++i) {
    HuffmanCodes codes;
    make_codes(tables.spec[i], codes);
    std::memcpy(code_and_length_ + 256 * i, codes.code_and_length, sizeof codes.code_and_length);
  }
}

// Appends the high n_bytes of an 8-byte word, stuffing.
void ScanWriter::put_bytes(Bits& bits, uint64_t value, int n_bytes) {
  for (int i = 0; i < n_bytes; ++i) {
    const auto byte = static_cast<uint8_t>(value >> (56 - 8 * i));
    *bits.out++ = byte;
    if (byte == 0xFF) *bits.out++ = 0;
  }
}

// count <= 32.
void ScanWriter::put(Bits& bits, uint32_t value, int count) {
  const int n = bits.n_pending + count;
  if (n <= 64) {
    bits.pending = bits.pending << count | value;
    bits.n_pending = n;
    return;
  }
  const int later = n - 64;  // bits of the value that the next 8 bytes begin with, 1..count
  const uint64_t word = bits.pending << (count - later) | value >> later;
  // A byte is 0xFF where its complement is zero: the classic test for a zero byte, on ~word.
  if (((~word - 0x0101010101010101u) & word & 0x8080808080808080u) == 0) {
    for (int i = 0; i < 8; ++i) bits.out[i] = static_cast<uint8_t>(word >> (56 - 8 * i));
    bits.out += 8;
  } else {
    put_bytes(bits, word, 8);
  }
  bits.pending = value;
  bits.n_pending = later;
}

void ScanWriter::pad_to_byte(Bits& bits) {
  if (bits.n_pending == 0) return;
  const int fill = 64 - bits.n_pending, n_bytes = (bits.n_pending + 7) / 8;
  const uint64_t ones = fill == 0 ? 0 : ~uint64_t{0} >> (64 - fill);
  put_bytes(bits, fill == 0 ? bits.pending : bits.pending << fill | ones, n_bytes);
  bits.n_pending = 0;
}

void ScanWriter::flush_chunk(Bits& bits) {
  sink_.append({chunk_, static_cast<size_t>(bits.out - chunk_)});
  bits.out = chunk_;
}

void ScanWriter::write(const Token* begin, const Token* end) {
  Bits bits = bits_;
  const uint8_t* const full = chunk_ + kChunk - kMaxFlush;
  for (const Token* token = begin; token != end; ++token) {
    if (bits.out > full) flush_chunk(bits);
    if ((*token & kRestartToken) != 0) {
      pad_to_byte(bits);
      *bits.out++ = 0xFF;
      *bits.out++ = static_cast<uint8_t>(0xD0 | (*token & 7));
      continue;
    }
    const uint32_t entry = code_and_length_[*token >> 16];
    const int size = static_cast<int>(*token >> 16 & 15);
    put(bits, (entry >> 8) << size | (*token & 0xFFFF), static_cast<int>(entry & 255) + size);
  }
  bits_ = bits;
}

void ScanWriter::finish() {
  pad_to_byte(bits_);
  flush_chunk(bits_);
}

}  // namespace pac::jpeg
