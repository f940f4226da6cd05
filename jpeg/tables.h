// The tables of Annex K: quantization steps (K.1) and "typical" Huffman tables (K.3).
#pragma once

#include <cstdint>

#include "jpeg/huffman.h"
#include "jpeg/jpeg.h"

namespace pac::jpeg {

extern const uint8_t kAnnexKLuma[64];    // natural order [T.81 table K.1]
extern const uint8_t kAnnexKChroma[64];  // [T.81 table K.2]

// [T.81 tables K.3-K.6]. table: 0 luma, 1 chroma.
const HuffmanSpec& standard_dc(int table);
const HuffmanSpec& standard_ac(int table);

// Real-valued steps, natural order: how large an error of each coefficient counts as one unit, which is what a tuning
// means by even quality. Rate-distortion choices minimize bits + kBitsPerSquaredStep * sum((error / reference)^2).
struct ReferenceSteps {
  double luma[64], chroma[64];
};
ReferenceSteps reference_of(const QuantTables& tables);
ReferenceSteps tuned_reference(Tune tune, double quality);

// The exchange rate at the margin of a uniform quantizer with many levels: D = step^2 / 12 and R = c - log2(step) give
// dD/dR = -(ln 2 / 6) step^2, about 1/8.7 squared step a bit; 8 serves the coarser quantizers of real use as well.
constexpr double kBitsPerSquaredStep = 8.0;

// base (tables of quality 50) scaled as annex_k_tables scales.
QuantTables scaled_tables(const ReferenceSteps& base, double quality);

}  // namespace pac::jpeg
