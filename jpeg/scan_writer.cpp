#include "jpeg/scan_writer.h"

#include <array>
#include <bit>
#include <cstring>

#include "jpeg/tables.h"

namespace pac::jpeg {
namespace {

// SSSS, the category of a value [T.81 tables F.1, F.2]: bits of its magnitude; and its extra bits, the value itself or,
// if negative, its one's complement's low bits. As a table (size << 16 | bits): signs and sizes are random, branches on
// them would cost more; and few values are not near its middle.
constexpr int kMaxValue = 2047;
constexpr std::array<uint32_t, 2 * kMaxValue + 2> make_value_tokens() {
  std::array<uint32_t, 2 * kMaxValue + 2> tokens{};
  for (int value = -kMaxValue; value <= kMaxValue; ++value) {
    const int magnitude = value < 0 ? -value : value;
    const auto size = static_cast<int>(std::bit_width(static_cast<uint32_t>(magnitude)));
    const int bits = value < 0 ? value + (1 << size) - 1 : value;
    tokens[static_cast<size_t>(value + kMaxValue)] = static_cast<uint32_t>(size) << 16 | static_cast<uint32_t>(bits);
  }
  return tokens;
}
constexpr auto kValueTokens = make_value_tokens();

uint32_t value_token(int value) {
  return kValueTokens[static_cast<size_t>(value + kMaxValue)];
}

// The low n_pending bits of `pending` wait for the rest of their 8 bytes; above them may be old ones.
struct Bits {
  uint64_t pending = 0;
  int n_free = 64;  // 64 - n_pending, 0..64
  uint8_t* out = nullptr;
};

// Appends the high n_bytes of an 8-byte word, stuffing.
void put_bytes(Bits& bits, uint64_t value, int n_bytes) {
  for (int i = 0; i < n_bytes; ++i) {
    const auto byte = static_cast<uint8_t>(value >> (56 - 8 * i));
    *bits.out++ = byte;
    if (byte == 0xFF) *bits.out++ = 0;
  }
}

void put_word(Bits& bits, uint64_t word) {
  // A byte is 0xFF where its complement is zero: the classic test for a zero byte, on ~word.
  if (((~word - 0x0101010101010101u) & word & 0x8080808080808080u) != 0) {
    put_bytes(bits, word, 8);
    return;
  }
  if constexpr (std::endian::native == std::endian::little) word = __builtin_bswap64(word);
  std::memcpy(bits.out, &word, 8);
  bits.out += 8;
}

// count 0..63; `value` has no bits above.
inline void put(Bits& bits, uint64_t value, int count) {
  const int n_free = bits.n_free - count;
  if (n_free >= 0) {
    bits.pending = bits.pending << count | value;
    bits.n_free = n_free;
    return;
  }
  // The value's last -n_free bits, 1..count, begin the next 8 bytes.
  put_word(bits, bits.pending << bits.n_free | value >> -n_free);
  bits.pending = value;
  bits.n_free = 64 + n_free;
}

void pad_to_byte(Bits& bits) {
  const int n_pending = 64 - bits.n_free;
  if (n_pending == 0) return;
  const uint64_t ones = bits.n_free == 0 ? 0 : ~uint64_t{0} >> n_pending;
  put_bytes(bits, bits.n_free == 0 ? bits.pending : bits.pending << bits.n_free | ones, (n_pending + 7) / 8);
  bits.n_free = 64;
}

// What put_block() looks up for one table pair.
struct BlockCodes {
  static constexpr int kSmall = 32;  // levels -32..31 have their code and extra bits in one entry
  uint32_t dc[16];                   // code << 5 | length, by SSSS
  uint32_t ac[256];                  // the same, by RRRRSSSS
  uint32_t small[16][2 * kSmall];    // by run and level + 32: (code, extra bits) << 5 | length, at most 16 + 6 bits
};

uint32_t joined(uint32_t code_and_length, uint32_t token) {
  const uint32_t size = token >> 16 & 15;
  return ((code_and_length >> 8) << size | (token & 0xFFFF)) << 5 | ((code_and_length & 255) + size);
}

void make_block_codes(const HuffmanCodes& dc, const HuffmanCodes& ac, BlockCodes& codes) {
  for (size_t i = 0; i < 16; ++i) codes.dc[i] = joined(dc.code_and_length[i], 0);
  for (size_t i = 0; i < 256; ++i) codes.ac[i] = joined(ac.code_and_length[i], 0);
  for (uint32_t run = 0; run < 16; ++run) {
    for (int level = -BlockCodes::kSmall; level < BlockCodes::kSmall; ++level) {
      const uint32_t token = value_token(level);
      codes.small[run][level + BlockCodes::kSmall] = joined(ac.code_and_length[run << 4 | token >> 16], token);
    }
  }
}

// Bits on their way to put(): several codes go out together.
struct Code {
  uint64_t value;
  int length;
};
// Of a BlockCodes entry.
Code code_of(uint32_t entry) {
  return {entry >> 5, static_cast<int>(entry & 31)};
}
Code append(Code first, Code second) {
  return {first.value << second.length | second.value, first.length + second.length};
}
// A value's extra bits behind the code of its symbol: at most 16 + 11 bits.
Code value_code(uint32_t entry, uint32_t token) {
  return append(code_of(entry), {token & 0xFFFF, static_cast<int>(token >> 16)});
}
void put(Bits& bits, Code code) {
  put(bits, code.value, code.length);
}

// The AC levels of a block as codes, one after the other.
struct AcCodes {
  const int16_t* levels;
  uint64_t rest;  // mask of those to come
  const BlockCodes& codes;
  int previous = 0;  // position of the last one

  // ZRLs that must come before it go out at once, behind the one that waits.
  Code next(Code& waiting, Bits& bits) {
    const int k = std::countr_zero(rest), level = levels[k];
    auto run = static_cast<uint32_t>(k - previous - 1);
    previous = k;
    rest &= rest - 1;
    if (run > 15) {
      put(bits, waiting);
      waiting = {0, 0};
      for (; run > 15; run -= 16) put(bits, code_of(codes.ac[0xF0]));
    }
    const auto small = static_cast<uint32_t>(level + BlockCodes::kSmall);
    if (small < 2 * BlockCodes::kSmall) return code_of(codes.small[run][small]);
    const uint32_t token = value_token(level);
    return value_code(codes.ac[run << 4 | token >> 16], token);
  }
  Code end() const { return previous != 63 ? code_of(codes.ac[0]) : Code{0, 0}; }  // EOB
};

// The bits of one block; arguments as of tokenize_block(). Codes go out in twos, at most 27 + 27 bits.
inline void put_block(const int16_t* levels, uint64_t nonzero, int dc_difference, const BlockCodes& codes, Bits& bits) {
  const uint32_t dc = value_token(dc_difference);
  Code first = value_code(codes.dc[dc >> 16], dc), none{0, 0};
  AcCodes ac{levels, nonzero & ~uint64_t{1}, codes};
  while (ac.rest != 0) {
    const Code second = ac.next(first, bits);
    put(bits, append(first, second));
    if (ac.rest == 0) {
      put(bits, ac.end());
      return;
    }
    first = ac.next(none, bits);
  }
  put(bits, append(first, ac.end()));
}

void put_restart(uint32_t number, Bits& bits) {
  pad_to_byte(bits);
  *bits.out++ = 0xFF;
  *bits.out++ = static_cast<uint8_t>(0xD0 | number);
}

}  // namespace

Token* TokenBuffer::reserve(size_t n) {
  if (size_ + n > capacity_) {
    capacity_ = size_ + n + capacity_ / 2;
    auto larger = std::make_unique_for_overwrite<Token[]>(capacity_);
    if (size_ > 0) std::memcpy(larger.get(), tokens_.get(), size_ * sizeof(Token));
    tokens_ = std::move(larger);
  }
  return tokens_.get() + size_;
}

Token* tokenize_block(const int16_t* levels, uint64_t nonzero, int dc_difference, uint32_t dc_table,
                      Histogram& histogram, Token* out) {
  const uint32_t ac_table = (dc_table + 1) << 24;
  const Token dc = value_token(dc_difference);
  histogram.count[dc_table][dc >> 16] += 1;
  *out++ = dc | dc_table << 24;
  uint32_t* counts = histogram.count[dc_table + 1];
  int previous = 0;
  for (uint64_t rest = nonzero & ~uint64_t{1}; rest != 0; rest &= rest - 1) {
    const int k = std::countr_zero(rest);
    uint32_t run = static_cast<uint32_t>(k - previous - 1);
    previous = k;
    for (; run > 15; run -= 16) {
      counts[0xF0] += 1;
      *out++ = ac_table | 0xF0u << 16;  // ZRL
    }
    const Token token = value_token(levels[k]) | run << 20;
    counts[token >> 16] += 1;
    *out++ = token | ac_table;
  }
  if (previous != 63) {
    counts[0] += 1;
    *out++ = ac_table;  // EOB
  }
  return out;
}

ScanTables standard_tables() {
  return {{standard_dc(0), standard_ac(0), standard_dc(1), standard_ac(1)}};
}

ScanTables difference_tables() {
  return {{difference_dc(0), difference_ac(0), difference_dc(1), difference_ac(1)}};
}

ScanTables fixed_tables(Huffman huffman) {
  return huffman == Huffman::difference ? difference_tables() : standard_tables();
}

ScanTables optimal_tables(const Histogram& histogram) {
  ScanTables tables;
  for (int i = 0; i < kTableCount; ++i) {
    uint64_t counts[256];
    for (int symbol = 0; symbol < 256; ++symbol) counts[symbol] = histogram.count[i][symbol];
    tables.spec[i] = optimal_huffman(counts);
  }
  return tables;
}

struct ScanWriter::State {
  static constexpr size_t kChunk = 32768;
  static constexpr size_t kMaxBlockBytes = 2 * (27 + 63 * 26) / 8 + 2;  // every byte stuffed
  static constexpr size_t kMaxTokenBytes = 18;                          // 8 stuffed ones; a marker

  void flush_chunk() {
    sink->append({chunk, static_cast<size_t>(bits.out - chunk)});
    bits.out = chunk;
  }
  void make_room(size_t n) {
    if (bits.out + n > chunk + kChunk) flush_chunk();
  }

  uint32_t code_and_length[kTableCount * 256] = {};  // by a token's upper half
  BlockCodes block_codes[2];
  HuffmanSpec block_specs[kTableCount];  // that block_codes are made of
  ByteSink* sink = nullptr;
  Bits bits;
  uint8_t chunk[kChunk];
};

ScanWriter::ScanWriter() : state_(std::make_unique<State>()) {}
ScanWriter::ScanWriter(ScanWriter&&) noexcept = default;
ScanWriter& ScanWriter::operator=(ScanWriter&&) noexcept = default;
ScanWriter::~ScanWriter() = default;

void ScanWriter::begin(const ScanTables& tables, bool direct, ByteSink& sink) {
  State& s = *state_;
  s.sink = &sink;
  s.bits = {};
  s.bits.out = s.chunk;
  HuffmanCodes codes[kTableCount];
  for (size_t i = 0; i < kTableCount; ++i) {
    make_codes(tables.spec[i], codes[i]);
    std::memcpy(s.code_and_length + 256 * i, codes[i].code_and_length, sizeof codes[i].code_and_length);
  }
  if (!direct || std::memcmp(s.block_specs, tables.spec, sizeof s.block_specs) == 0) return;
  std::memcpy(s.block_specs, tables.spec, sizeof s.block_specs);
  make_block_codes(codes[kDc0], codes[kAc0], s.block_codes[0]);
  make_block_codes(codes[kDc1], codes[kAc1], s.block_codes[1]);
}

void ScanWriter::write_mcu_row(int mcu_row, const Levels& levels, BlockWalker& walker) {
  State& s = *state_;
  Bits bits = s.bits;  // a copy that the compiler keeps in registers
  const auto make_room = [&bits, &s](size_t n) {
    if (bits.out + n <= s.chunk + State::kChunk) return;
    s.bits.out = bits.out;
    s.flush_chunk();
    bits.out = s.bits.out;
  };
  walker.walk(
      mcu_row, levels,
      [&](const int16_t* block, uint64_t nonzero, int dc_difference, int table) {
        make_room(State::kMaxBlockBytes);
        put_block(block, nonzero, dc_difference, s.block_codes[table], bits);
      },
      [&](uint32_t number) {
        make_room(State::kMaxTokenBytes);
        put_restart(number, bits);
      });
  s.bits = bits;
}

void ScanWriter::write(const Token* begin, const Token* end) {
  State& s = *state_;
  while (begin != end) {
    // As many tokens as surely fit: each needs at most 4 bytes, stuffed 8.
    constexpr ptrdiff_t kTokens = State::kChunk / 8 - State::kMaxTokenBytes;
    s.flush_chunk();
    const Token* const stop = end - begin < kTokens ? end : begin + kTokens;
    Bits bits = s.bits;
    for (; begin != stop && (*begin & kRestartToken) == 0; ++begin) {
      const uint32_t entry = s.code_and_length[*begin >> 16];
      const int size = static_cast<int>(*begin >> 16 & 15);
      put(bits, (entry >> 8) << size | (*begin & 0xFFFF), static_cast<int>(entry & 255) + size);
    }
    s.bits = bits;
    if (begin != stop) put_restart(*begin++ & 7, s.bits);
  }
}

void ScanWriter::finish() {
  State& s = *state_;
  s.make_room(State::kMaxTokenBytes);
  pad_to_byte(s.bits);
  s.flush_chunk();
}

}  // namespace pac::jpeg
