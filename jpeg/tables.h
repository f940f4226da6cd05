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

// For difference images [jpeg/difference_tables.cpp]: every symbol of a baseline file has a code. table: as above.
const HuffmanSpec& difference_dc(int table);
const HuffmanSpec& difference_ac(int table);

// Real-valued steps, natural order: how large an error of each coefficient counts as one unit, which is what a tuning
// means by even quality. Rate-distortion choices minimize bits + kBitsPerSquaredStep * sum((error / reference)^2).
struct ReferenceSteps {
  double luma[64], chroma[64];
};
ReferenceSteps reference_of(const QuantTables& tables);
ReferenceSteps tuned_reference(Tune tune, double quality);

// What a squared error of one reference step is worth, in bits. At the margin of a uniform quantizer with many levels
// D = step^2 / 12 and R = c - log2(step) give dD/dR = -(ln 2 / 6) step^2, about 1/8.7 squared step a bit; 8 serves the
// coarser quantizers of real use as well, and squared error. The others, found on training pictures, make the trellis
// drop less: a level dropped hurts structure more than its squared error tells.
struct ExchangeRates {
  double design = 8.0, trellis = 8.0;
};
ExchangeRates exchange_rates(Tune tune);

// What chroma coefficients are multiplied by before quantization, natural order. Decoders interpolate subsampled chroma
// linearly (1 3 3 1)/4, which takes high frequencies down; the samples that come nearest after it are sharper than the
// box means of the encoder. Along a subsampled axis: 1 + 2 a (1 - cos(pi u / 8)), the filter (-a, 1 + 2a, -a). The
// least squared error of RGB wants it (a = 0.15, 2.5 % of bytes at equal error); SSIM of luma and SSIMULACRA 2.1 do
// not: their a is 0.
struct ChromaGain {
  double gain[64];
};
ChromaGain chroma_gain(Tune tune, bool is_halved_across, bool is_halved_down);

// base (tables of quality 50) scaled as annex_k_tables scales.
QuantTables scaled_tables(const ReferenceSteps& base, double quality);

}  // namespace pac::jpeg
