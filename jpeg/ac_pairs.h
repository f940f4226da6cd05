// A look-up that decodes up to two AC levels and an EOB at once: codes are short where there are many of them, and each
// look-up waits for the one before it.
#pragma once

#include <cstdint>

#include "jpeg/huffman.h"

namespace pac::jpeg {

struct AcPairs {
  static constexpr int kBits = 10;            // of the index: the next bits of the scan
  static constexpr uint8_t kEnds = 0x80;      // the block ends here
  static constexpr uint8_t kNotHere = 0x80;   // advance: no whole code and extra bits fit the index, or it is a ZRL
  static constexpr uint8_t kLengthMask = 63;  // bits to consume, in `length_and_end`

  // From position k on: level[0] stands at k + place[0], level[1] at k + place[1], where level[1] may be 0 and then
  // stands behind level[0]; the next position is k + advance, of which an EOB counts one. All of it is valid where
  // k + advance <= 64: two levels, or a level and an EOB, then lie inside the block, and it has not ended before.
  struct Entry {
    int16_t level[2];
    uint8_t place[2];
    uint8_t advance;
    uint8_t length_and_end;
  };
  Entry lookup[1 << kBits];
};

void make_ac_pairs(const HuffmanDecoder& table, AcPairs& pairs);

}  // namespace pac::jpeg
