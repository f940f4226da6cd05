// Huffman tables: as a DHT segment lists them, as codes for the encoder, as look-up tables for the decoder, and the
// best ones for a histogram.
#pragma once

#include <cstdint>
#include <span>

namespace pac::jpeg {

constexpr int kMaxCodeLength = 16;

// A table as DHT carries it [T.81 B.2.4.2]: count[l] codes of l bits (BITS; count[0] unused), their symbols (HUFFVAL)
// in order of increasing code.
struct HuffmanSpec {
  uint8_t count[kMaxCodeLength + 1] = {};
  uint8_t symbols[256] = {};
  int n_symbols() const {
    int n = 0;
    for (int length = 1; length <= kMaxCodeLength; ++length) n += count[length];
    return n;
  }
};

// At most 256 symbols, no length has more codes than are left, and the code of all ones stays free [T.81 C.2, K.2].
// Empty tables are valid. The IJG software tolerates a table that uses the all-ones code; so does this.
bool is_valid(const HuffmanSpec& spec);

// For the encoder: (code << 8 | length) of each symbol, 0 where there is none [T.81 C.3, EHUFCO and EHUFSI].
struct HuffmanCodes {
  uint32_t code_and_length[256] = {};
};
void make_codes(const HuffmanSpec& spec, HuffmanCodes& codes);

// The table with the fewest total bits for symbols that occur frequency[s] times, with code lengths limited to 16 and
// the all-ones code left free: package-merge (Larmore, Hirschberg 1990), which is optimal under the limit, where the
// procedure of T.81 K.2 is a heuristic. Symbols that do not occur get no code.
HuffmanSpec optimal_huffman(std::span<const uint64_t, 256> frequency);

// The same, but every symbol that a baseline file of 8-bit samples can hold [T.81 tables F.1, F.2] has a code: one that
// was not seen counts as a 64th of one that was seen once. Frequencies below 2^57.
HuffmanSpec complete_huffman(bool is_dc, std::span<const uint64_t, 256> frequency);

// For the decoder. The next kLookupBits bits index `lookup`; codes longer than that take the canonical search.
struct HuffmanDecoder {
  static constexpr int kLookupBits = 10;
  struct Entry {
    int16_t value;   // the coefficient, when the code and its extra bits all fit the index; else 0
    uint8_t symbol;  // RRRRSSSS
    uint8_t length;  // bits to consume: code and extra bits when value != 0, else the code alone; 0: longer code
  };
  Entry lookup[1 << kLookupBits];
  int32_t max_code[kMaxCodeLength + 2];  // largest code of that length, -1 if none; the last entry stops the search
  int32_t offset[kMaxCodeLength + 1];    // symbols[] index of code c of length l is c + offset[l]
  uint8_t symbols[256];
};
void make_decoder(const HuffmanSpec& spec, HuffmanDecoder& decoder);

// The value that `size` extra bits stand for [T.81 F.2.2.1 EXTEND]; size 1..16.
constexpr int extend(uint32_t bits, int size) {
  const int value = static_cast<int>(bits);
  return value < 1 << (size - 1) ? value - (1 << size) + 1 : value;
}

}  // namespace pac::jpeg
