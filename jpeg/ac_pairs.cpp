#include "jpeg/ac_pairs.h"

namespace pac::jpeg {
namespace {

static_assert(AcPairs::kBits == HuffmanDecoder::kLookupBits);

bool is_eob(HuffmanDecoder::Entry entry) {
  return entry.length > 0 && entry.value == 0 && entry.symbol == 0;
}

// What stands behind `used` bits of the index: valid if it ends inside the index.
HuffmanDecoder::Entry entry_behind(const HuffmanDecoder& table, uint32_t index, int used) {
  const HuffmanDecoder::Entry entry = table.lookup[index << used & ((1u << AcPairs::kBits) - 1)];
  return used + entry.length <= AcPairs::kBits ? entry : HuffmanDecoder::Entry{};
}

AcPairs::Entry pair_entry(const HuffmanDecoder& table, uint32_t index) {
  AcPairs::Entry pair{{0, 0}, {0, 0}, 0, 0};
  int n_levels = 0, length = 0;
  for (; n_levels < 2; ++n_levels) {
    const HuffmanDecoder::Entry entry = entry_behind(table, index, length);
    if (entry.value == 0) break;
    pair.level[n_levels] = entry.value;
    pair.place[n_levels] = static_cast<uint8_t>(pair.advance + (entry.symbol >> 4));
    pair.advance = static_cast<uint8_t>(pair.place[n_levels] + 1);
    length += entry.length;
  }
  if (n_levels == 1) pair.place[1] = pair.advance;
  const HuffmanDecoder::Entry next = entry_behind(table, index, length);
  if (is_eob(next)) {
    pair.advance = static_cast<uint8_t>(pair.advance + 1);
    length += next.length;
  } else if (n_levels == 0) {
    pair.advance = AcPairs::kNotHere;
  }
  pair.length_and_end = static_cast<uint8_t>(length | (is_eob(next) ? AcPairs::kEnds : 0));
  return pair;
}

}  // namespace

void make_ac_pairs(const HuffmanDecoder& table, AcPairs& pairs) {
  for (uint32_t index = 0; index < 1u << AcPairs::kBits; ++index) pairs.lookup[index] = pair_entry(table, index);
}

}  // namespace pac::jpeg
