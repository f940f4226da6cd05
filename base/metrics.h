// How far apart two pictures are, and how much information one holds. Every figure has the same bits on every system:
// integer sums where possible, else IEEE doubles in a fixed order (base/exact_math.h, no libm).
#pragma once

#include <cstdint>

#include "base/image.h"

namespace pac {

class ThreadPool;

// BT.601 luma, full range: round(0.299 R + 0.587 G + 0.114 B), in 16-bit fixed point.
constexpr uint8_t luma_bt601(int r, int g, int b) {
  return static_cast<uint8_t>((19595 * r + 38470 * g + 7471 * b + 32768) >> 16);
}
GrayImage luma_of(ConstRgbView image);

// All of these take two pictures of equal, nonzero size (else PAC_ASSERT).

// Mean of squared differences over all samples of all channels.
double mean_squared_error(ConstRgbView reference, ConstRgbView test);
double mean_squared_error(PlaneView<const uint8_t> reference, PlaneView<const uint8_t> test);

// The paper's rms: root of the mean over all 3 * width * height samples, in levels of 0..255 [Levoy95 s.3].
double rms_error(ConstRgbView reference, ConstRgbView test);

// 10 log10(255^2 / mse) in dB; +infinity for mse == 0 (printers of JSON: write null).
double psnr_from_mse(double mse);
double psnr_rgb(ConstRgbView reference, ConstRgbView test);   // mse over the samples of all three channels
double psnr_luma(ConstRgbView reference, ConstRgbView test);  // mse of luma_bt601

// Mean structural similarity of two gray pictures [Wang et al. 2004]: 11x11 Gaussian window with sigma 1.5, K1 = 0.01,
// K2 = 0.03, L = 255, windows that lie inside the picture, no downsampling. In -1..1, 1 = equal. Sides below 11 shrink
// the window: the Gaussian is cut to the side (the largest odd number of taps that fits) and normalized.
double ssim(PlaneView<const uint8_t> reference, PlaneView<const uint8_t> test);
double ssim_luma(ConstRgbView reference, ConstRgbView test);  // of luma_bt601

// The SSIM of every window, at the window's center: width - 10 by height - 10 values for sides of 11 and more.
DepthImage ssim_map(PlaneView<const uint8_t> reference, PlaneView<const uint8_t> test);

// Multi-scale SSIM [Wang, Simoncelli, Bovik 2003]: five scales, 2x2 means between them, contrast-structure
// means to the powers 0.0448, 0.2856, 0.3001, 0.2363, full SSIM of the last scale to 0.1333. Negative means count as 0.
// Fewer scales, the exponents normalized to sum 1, where a side would fall below 11.
double ms_ssim(PlaneView<const uint8_t> reference, PlaneView<const uint8_t> test);
double ms_ssim_luma(ConstRgbView reference, ConstRgbView test);  // of luma_bt601

// First-order entropy: -sum p log2 p over the histogram of ...
double entropy_per_channel(ConstRgbView image);  // each channel alone, mean of the three: bits a sample, 0..8
double entropy_luma(ConstRgbView image);         // luma_bt601: bits a pixel, 0..8
double entropy_joint(ConstRgbView image);        // (R, G, B) triples: bits a pixel, 0..24
double entropy(PlaneView<const uint8_t> image);  // one plane: bits a sample

// Bytes of the raw picture (3 a pixel) for one byte of code, the paper's compression ratio n:1. size_bytes >= 1.
double compression_ratio(int width, int height, uint64_t size_bytes);

// Flicker: rms of the error in the change between two successive frames, (test - previous test) - (reference - previous
// reference), in levels; 0 if every change is right, whatever the frames look like. Four planes of equal, nonzero size.
double flicker_rms(PlaneView<const uint8_t> previous_reference, PlaneView<const uint8_t> reference,
                   PlaneView<const uint8_t> previous_test, PlaneView<const uint8_t> test);

struct Metrics {
  double rms = 0;                             // levels
  double psnr_rgb_db = 0, psnr_luma_db = 0;   // +infinity where equal
  double psnr_hvs_db = 0, psnr_hvs_m_db = 0;  // of luma, +infinity where nothing is visible (base/psnr_hvs.h)
  double ssim = 0, ms_ssim = 0;               // of luma
  double ssimulacra2 = 0;                     // 100 = equal (base/ssimulacra2.h)
  double flip = 0;                            // 0 = equal, 1 = largest (base/flip.h)
  int max_error = 0;                          // largest difference of any sample, levels
};
// All of them; reference and test of equal, nonzero size. Same bits for every number of threads.
Metrics measure(ConstRgbView reference, ConstRgbView test, ThreadPool* pool = nullptr);

// |reference - test| * gain, clamped to 255, sample by sample: a picture of where the error is.
RgbImage error_map(ConstRgbView reference, ConstRgbView test, int gain = 8);

}  // namespace pac
