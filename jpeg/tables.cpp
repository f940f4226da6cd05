#include "jpeg/tables.h"

#include <cmath>

#include "base/exact_math.h"
#include "jpeg/jpeg.h"

namespace pac::jpeg {
namespace {

constexpr HuffmanSpec kDcLuma = {{0, 0, 1, 5, 1, 1, 1, 1, 1, 1}, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}};
constexpr HuffmanSpec kDcChroma = {{0, 0, 3, 1, 1, 1, 1, 1, 1, 1, 1, 1}, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}};

constexpr HuffmanSpec kAcLuma = {
    {0, 0, 2, 1, 3, 3, 2, 4, 3, 5, 5, 4, 4, 0, 0, 1, 0x7d},
    {0x01, 0x02, 0x03, 0x00, 0x04, 0x11, 0x05, 0x12, 0x21, 0x31, 0x41, 0x06, 0x13, 0x51, 0x61, 0x07, 0x22, 0x71,
     0x14, 0x32, 0x81, 0x91, 0xa1, 0x08, 0x23, 0x42, 0xb1, 0xc1, 0x15, 0x52, 0xd1, 0xf0, 0x24, 0x33, 0x62, 0x72,
     0x82, 0x09, 0x0a, 0x16, 0x17, 0x18, 0x19, 0x1a, 0x25, 0x26, 0x27, 0x28, 0x29, 0x2a, 0x34, 0x35, 0x36, 0x37,
     0x38, 0x39, 0x3a, 0x43, 0x44, 0x45, 0x46, 0x47, 0x48, 0x49, 0x4a, 0x53, 0x54, 0x55, 0x56, 0x57, 0x58, 0x59,
     0x5a, 0x63, 0x64, 0x65, 0x66, 0x67, 0x68, 0x69, 0x6a, 0x73, 0x74, 0x75, 0x76, 0x77, 0x78, 0x79, 0x7a, 0x83,
     0x84, 0x85, 0x86, 0x87, 0x88, 0x89, 0x8a, 0x92, 0x93, 0x94, 0x95, 0x96, 0x97, 0x98, 0x99, 0x9a, 0xa2, 0xa3,
     0xa4, 0xa5, 0xa6, 0xa7, 0xa8, 0xa9, 0xaa, 0xb2, 0xb3, 0xb4, 0xb5, 0xb6, 0xb7, 0xb8, 0xb9, 0xba, 0xc2, 0xc3,
     0xc4, 0xc5, 0xc6, 0xc7, 0xc8, 0xc9, 0xca, 0xd2, 0xd3, 0xd4, 0xd5, 0xd6, 0xd7, 0xd8, 0xd9, 0xda, 0xe1, 0xe2,
     0xe3, 0xe4, 0xe5, 0xe6, 0xe7, 0xe8, 0xe9, 0xea, 0xf1, 0xf2, 0xf3, 0xf4, 0xf5, 0xf6, 0xf7, 0xf8, 0xf9, 0xfa}};

constexpr HuffmanSpec kAcChroma = {
    {0, 0, 2, 1, 2, 4, 4, 3, 4, 7, 5, 4, 4, 0, 1, 2, 0x77},
    {0x00, 0x01, 0x02, 0x03, 0x11, 0x04, 0x05, 0x21, 0x31, 0x06, 0x12, 0x41, 0x51, 0x07, 0x61, 0x71, 0x13, 0x22,
     0x32, 0x81, 0x08, 0x14, 0x42, 0x91, 0xa1, 0xb1, 0xc1, 0x09, 0x23, 0x33, 0x52, 0xf0, 0x15, 0x62, 0x72, 0xd1,
     0x0a, 0x16, 0x24, 0x34, 0xe1, 0x25, 0xf1, 0x17, 0x18, 0x19, 0x1a, 0x26, 0x27, 0x28, 0x29, 0x2a, 0x35, 0x36,
     0x37, 0x38, 0x39, 0x3a, 0x43, 0x44, 0x45, 0x46, 0x47, 0x48, 0x49, 0x4a, 0x53, 0x54, 0x55, 0x56, 0x57, 0x58,
     0x59, 0x5a, 0x63, 0x64, 0x65, 0x66, 0x67, 0x68, 0x69, 0x6a, 0x73, 0x74, 0x75, 0x76, 0x77, 0x78, 0x79, 0x7a,
     0x82, 0x83, 0x84, 0x85, 0x86, 0x87, 0x88, 0x89, 0x8a, 0x92, 0x93, 0x94, 0x95, 0x96, 0x97, 0x98, 0x99, 0x9a,
     0xa2, 0xa3, 0xa4, 0xa5, 0xa6, 0xa7, 0xa8, 0xa9, 0xaa, 0xb2, 0xb3, 0xb4, 0xb5, 0xb6, 0xb7, 0xb8, 0xb9, 0xba,
     0xc2, 0xc3, 0xc4, 0xc5, 0xc6, 0xc7, 0xc8, 0xc9, 0xca, 0xd2, 0xd3, 0xd4, 0xd5, 0xd6, 0xd7, 0xd8, 0xd9, 0xda,
     0xe2, 0xe3, 0xe4, 0xe5, 0xe6, 0xe7, 0xe8, 0xe9, 0xea, 0xf2, 0xf3, 0xf4, 0xf5, 0xf6, 0xf7, 0xf8, 0xf9, 0xfa}};

// The IJG software's percentage. Beyond 5000 / 0.1 every step is clamped anyway; that bounds the arithmetic.
double scale_percent(double quality) {
  const double q = !(quality >= 0.1) ? 0.1 : quality > 100.0 ? 100.0 : quality;
  return q < 50.0 ? 5000.0 / q : 200.0 - 2.0 * q;
}

// Positive values are truncated, which is their floor.
uint16_t to_step(double value) {
  return static_cast<uint16_t>(value < 1.0 ? 1 : value >= 255.0 ? 255 : static_cast<int>(value));
}

QuantTable scaled(const double (&base)[64], double percent) {
  QuantTable table;
  for (size_t i = 0; i < 64; ++i) table[i] = to_step((base[i] * percent + 50.0) / 100.0);
  return table;
}

// Steps at quality 50 by u + v, the sum of a coefficient's frequencies. Found by descent over a few parameters (height,
// slope and bend of luma and of chroma) to the least bytes at equal quality, mean of photographs, renderings and
// difference images, with the trellis: ssim at SSIM, visual at SSIMULACRA 2.1. Their heights are such that a quality
// takes about the bytes that it takes with Annex K's tables.
constexpr double kVisualLuma[15] = {18.0, 30.4, 36.9, 42.3, 46.9, 51.1, 55.0, 58.7,
                                    62.1, 65.4, 68.6, 71.6, 74.5, 77.4, 80.1};
constexpr double kVisualChroma[15] = {21.2, 31.0, 36.1, 40.3, 44.0, 47.3, 50.4, 53.2,
                                      56.0, 58.6, 61.0, 63.4, 65.7, 67.9, 70.1};
constexpr double kSsimChroma[15] = {72.8,  78.8,  82.8,  86.3,  89.6,  92.6,  95.4, 98.0,
                                    100.8, 103.2, 105.7, 108.2, 110.5, 112.7, 115.1};

// The energy that (1 3 3 1)/4 interpolation along one axis leaves of frequency u, which doubles flat samples' energy.
double interpolated_energy(int u) {
  return (10.0 + 6.0 * exact_cos(kPi * u / 8)) / 16;
}

// psnr: an error of a chroma sample spreads over four pixels, which alone would make its step half of luma's; less so
// at high frequencies, where the interpolation takes errors down as well. The exponent of that is less than theory's
// 0.5: most chroma errors are zeroed coefficients.
// hvs: PSNR-HVS-M weighs errors of luma by the steps of K.1, but lets more of them hide the larger those are, and none
// of DC's; the rest found on training pictures.
ReferenceSteps tuned_base(Tune tune) {
  constexpr double kFlatLuma = 28.0, kPsnrSlope = 0.2, kPsnrChroma = 0.55 * kFlatLuma, kPsnrExponent = -0.4;
  constexpr double kHvsExponent = 0.15, kHvsChroma = 0.7;
  ReferenceSteps base;
  for (int i = 0; i < 64; ++i) {
    const int u = i % 8, v = i / 8, frequency = u + v;
    switch (tune) {
      case Tune::psnr:
        base.luma[i] = kFlatLuma * (1.0 + kPsnrSlope * frequency / 14.0);
        base.chroma[i] = kPsnrChroma * exact_pow(interpolated_energy(u) * interpolated_energy(v), kPsnrExponent);
        break;
      case Tune::ssim:
        base.luma[i] = kFlatLuma;
        base.chroma[i] = kSsimChroma[frequency];
        break;
      case Tune::visual:
        base.luma[i] = kVisualLuma[frequency];
        base.chroma[i] = kVisualChroma[frequency];
        break;
      case Tune::hvs:
        base.luma[i] = kAnnexKLuma[i] * (i == 0 ? 0.5 : exact_pow(kAnnexKLuma[i] / 16.0, kHvsExponent));
        base.chroma[i] = kHvsChroma * kSsimChroma[frequency];
        break;
    }
  }
  return base;
}

}  // namespace

const uint8_t kAnnexKLuma[64] = {16, 11, 10, 16, 24,  40,  51,  61,   //
                                 12, 12, 14, 19, 26,  58,  60,  55,   //
                                 14, 13, 16, 24, 40,  57,  69,  56,   //
                                 14, 17, 22, 29, 51,  87,  80,  62,   //
                                 18, 22, 37, 56, 68,  109, 103, 77,   //
                                 24, 35, 55, 64, 81,  104, 113, 92,   //
                                 49, 64, 78, 87, 103, 121, 120, 101,  //
                                 72, 92, 95, 98, 112, 100, 103, 99};

const uint8_t kAnnexKChroma[64] = {17, 18, 24, 47, 99, 99, 99, 99,  //
                                   18, 21, 26, 66, 99, 99, 99, 99,  //
                                   24, 26, 56, 99, 99, 99, 99, 99,  //
                                   47, 66, 99, 99, 99, 99, 99, 99,  //
                                   99, 99, 99, 99, 99, 99, 99, 99,  //
                                   99, 99, 99, 99, 99, 99, 99, 99,  //
                                   99, 99, 99, 99, 99, 99, 99, 99,  //
                                   99, 99, 99, 99, 99, 99, 99, 99};

const HuffmanSpec& standard_dc(int table) {
  return table == 0 ? kDcLuma : kDcChroma;
}

const HuffmanSpec& standard_ac(int table) {
  return table == 0 ? kAcLuma : kAcChroma;
}

QuantTables scaled_tables(const ReferenceSteps& base, double quality) {
  const double percent = scale_percent(quality);
  return {scaled(base.luma, percent), scaled(base.chroma, percent)};
}

QuantTables annex_k_tables(double quality) {
  ReferenceSteps base;
  for (int i = 0; i < 64; ++i) {
    base.luma[i] = kAnnexKLuma[i];
    base.chroma[i] = kAnnexKChroma[i];
  }
  return scaled_tables(base, quality);
}

QuantTables tuned_tables(Tune tune, double quality) {
  return scaled_tables(tuned_base(tune), quality);
}

ReferenceSteps reference_of(const QuantTables& tables) {
  ReferenceSteps reference;
  for (size_t i = 0; i < 64; ++i) {
    reference.luma[i] = tables.luma[i];
    reference.chroma[i] = tables.chroma[i];
  }
  return reference;
}

ReferenceSteps tuned_reference(Tune tune, double quality) {
  ReferenceSteps reference = tuned_base(tune);
  const double factor = scale_percent(quality) / 100.0;
  for (size_t i = 0; i < 64; ++i) {
    // Below half a step nothing is gained: the transform's own rounding is that large.
    reference.luma[i] = std::fmax(reference.luma[i] * factor, 0.5);
    reference.chroma[i] = std::fmax(reference.chroma[i] * factor, 0.5);
  }
  return reference;
}

ExchangeRates exchange_rates(Tune tune) {
  switch (tune) {
    case Tune::ssim:
      return {8.0, 14.0};
    case Tune::visual:
      return {10.0, 12.0};
    case Tune::hvs:
      return {7.0, 8.0};
    default:
      return {};
  }
}

ChromaGain chroma_gain(Tune tune, bool is_halved_across, bool is_halved_down) {
  const double a = tune == Tune::psnr ? 0.15 : 0.0;
  const double across = is_halved_across ? a : 0.0, down = is_halved_down ? a : 0.0;
  ChromaGain chroma;
  for (int i = 0; i < 64; ++i)
    chroma.gain[i] = (1.0 + 2.0 * across * (1.0 - exact_cos(kPi * (i % 8) / 8))) *
                     (1.0 + 2.0 * down * (1.0 - exact_cos(kPi * (i / 8) / 8)));
  return chroma;
}

QuantTables halved(const QuantTables& tables) {
  QuantTables half;
  for (size_t i = 0; i < 64; ++i) {
    half.luma[i] = static_cast<uint16_t>(tables.luma[i] <= 1 ? 1 : (tables.luma[i] + 1) / 2);
    half.chroma[i] = static_cast<uint16_t>(tables.chroma[i] <= 1 ? 1 : (tables.chroma[i] + 1) / 2);
  }
  return half;
}

}  // namespace pac::jpeg
