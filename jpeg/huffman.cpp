#include "jpeg/huffman.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "base/huffman_lengths.h"

namespace pac::jpeg {
namespace {

// The entries whose index begins with one code, each as 4 bytes.
void fill_entries(int code_length, uint8_t symbol, uint32_t* out) {
  constexpr int kValueShift = std::endian::native == std::endian::little ? 0 : 16;
  const int size = symbol & 15, spare = HuffmanDecoder::kLookupBits - code_length;
  const bool has_value = size > 0 && size <= spare;
  const auto length = static_cast<uint8_t>(code_length + (has_value ? size : 0));
  const auto entry = std::bit_cast<uint32_t>(HuffmanDecoder::Entry{0, symbol, length});
  const uint32_t n = 1u << spare;
  if (!has_value) {
    std::fill_n(out, n, entry);
    return;
  }
  const int shift = spare - size, half = 1 << (size - 1), lowest = 1 - (1 << size);
  for (uint32_t i = 0; i < n; ++i) {
    const auto bits = static_cast<int>(i >> shift);
    const int value = bits < half ? bits + lowest : bits;  // EXTEND
    out[i] = entry | (static_cast<uint32_t>(value) & 0xFFFF) << kValueShift;
  }
}

// Whether a baseline file of 8-bit samples can hold the symbol [T.81 tables F.1, F.2].
bool can_occur(bool is_dc, uint32_t symbol) {
  const uint32_t run = symbol >> 4, size = symbol & 15;
  if (is_dc) return symbol <= 11;
  return size == 0 ? run == 0 || run == 15 : size <= 10;
}

}  // namespace

bool is_valid(const HuffmanSpec& spec) {
  int total = 0;
  uint32_t free_codes = 1;  // of the current length
  for (int length = 1; length <= kMaxCodeLength; ++length) {
    free_codes *= 2;
    if (spec.count[length] > free_codes) return false;
    free_codes -= spec.count[length];
    total += spec.count[length];
  }
  return total <= 256;
}

void make_codes(const HuffmanSpec& spec, HuffmanCodes& codes) {
  codes = {};
  uint32_t code = 0;
  int k = 0;
  for (int length = 1; length <= kMaxCodeLength; ++length, code <<= 1)
    for (int i = 0; i < spec.count[length]; ++i, ++code, ++k)
      codes.code_and_length[spec.symbols[k]] = code << 8 | static_cast<uint32_t>(length);
}

HuffmanSpec optimal_huffman(std::span<const uint64_t, 256> frequency) {
  // Frequencies scaled so that the largest has 30 bits, at least 2: lighter than any of them, leaf 256 is nobody's
  // symbol. So no code is longer than its, and as the last one of its length (all ones) it keeps that one free.
  constexpr int kBits = 30;
  constexpr size_t kReserved = 256;
  uint64_t largest = 0;
  for (const uint64_t f : frequency) largest = std::max(largest, f);
  HuffmanSpec spec;
  if (largest == 0) return spec;
  const int shift = static_cast<int>(std::bit_width(largest)) - kBits;
  uint32_t weights[257] = {};
  for (size_t s = 0; s < 256; ++s)
    if (frequency[s] > 0)
      weights[s] =
          static_cast<uint32_t>(std::max<uint64_t>(shift > 0 ? frequency[s] >> shift : frequency[s] << -shift, 2));
  weights[kReserved] = 1;
  uint8_t lengths[257];
  optimal_code_lengths(weights, kMaxCodeLength, lengths);
  int k = 0;
  for (uint8_t length = 1; length <= kMaxCodeLength; ++length)
    for (size_t s = 0; s < 256; ++s)
      if (lengths[s] == length) {
        spec.count[length] = static_cast<uint8_t>(spec.count[length] + 1);
        spec.symbols[k++] = static_cast<uint8_t>(s);
      }
  return spec;
}

HuffmanSpec complete_huffman(bool is_dc, std::span<const uint64_t, 256> frequency) {
  constexpr uint64_t kWeight = 64;
  uint64_t counts[256];
  for (uint32_t symbol = 0; symbol < 256; ++symbol)
    counts[symbol] = can_occur(is_dc, symbol) ? kWeight * frequency[symbol] + 1 : 0;
  return optimal_huffman(counts);
}

void make_decoder(const HuffmanSpec& spec, HuffmanDecoder& decoder) {
  constexpr int kBits = HuffmanDecoder::kLookupBits;
  uint32_t entries[1 << kBits];
  std::memcpy(decoder.symbols, spec.symbols, sizeof decoder.symbols);
  int32_t code = 0, k = 0;
  for (int length = 1; length <= kMaxCodeLength; ++length, code <<= 1) {
    decoder.offset[length] = k - code;
    for (int i = 0; i < spec.count[length]; ++i, ++code, ++k) {
      if (length > kBits) continue;
      fill_entries(length, spec.symbols[k], entries + (static_cast<size_t>(code) << (kBits - length)));
    }
    decoder.max_code[length] = spec.count[length] > 0 ? code - 1 : -1;
    if (length == kBits) std::fill(entries + code, std::end(entries), 0u);
  }
  std::memcpy(decoder.lookup, entries, sizeof entries);
  decoder.offset[0] = 0;
  decoder.max_code[0] = 0;
  decoder.max_code[kMaxCodeLength + 1] = INT32_MAX;
}

}  // namespace pac::jpeg
