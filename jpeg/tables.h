// The tables of Annex K: quantization steps (K.1) and "typical" Huffman tables (K.3).
#pragma once

#include <cstdint>

#include "jpeg/huffman.h"

namespace pac::jpeg {

extern const uint8_t kAnnexKLuma[64];    // natural order [T.81 table K.1]
extern const uint8_t kAnnexKChroma[64];  // [T.81 table K.2]

// [T.81 tables K.3-K.6]. table: 0 luma, 1 chroma.
const HuffmanSpec& standard_dc(int table);
const HuffmanSpec& standard_ac(int table);

}  // namespace pac::jpeg
