#include "base/psnr_hvs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "base/exact_math.h"
#include "base/metrics.h"

namespace pac {
namespace {

constexpr int kSide = 8;
constexpr size_t kSize = 64;
using Block = std::array<double, kSize>;  // row by row

// Luma table of JPEG, in natural order [T.81 Table K.1].
constexpr std::array<int, kSize> kTableK1{16, 11, 10, 16, 24,  40,  51,  61,   //
                                          12, 12, 14, 19, 26,  58,  60,  55,   //
                                          14, 13, 16, 24, 40,  57,  69,  56,   //
                                          14, 17, 22, 29, 51,  87,  80,  62,   //
                                          18, 22, 37, 56, 68,  109, 103, 77,   //
                                          24, 35, 55, 64, 81,  104, 113, 92,   //
                                          49, 64, 78, 87, 103, 121, 120, 101,  //
                                          72, 92, 95, 98, 112, 100, 103, 99};

// The authors' two tables, which they print to six digits, are these functions of K.1: sensitivity 25.73509 / q,
// masking (10 / q)^2.
struct Tables {
  Block sensitivity, masking;
  Block cosine;  // orthonormal DCT-II: row u, column x
  Tables() {
    for (size_t i = 0; i < kSize; ++i) {
      const double q = kTableK1[i];
      sensitivity[i] = 25.73509 / q;
      masking[i] = 100 / (q * q);
    }
    for (int u = 0; u < kSide; ++u)
      for (int x = 0; x < kSide; ++x)
        cosine[static_cast<size_t>(kSide * u + x)] =
            (u == 0 ? std::sqrt(0.125) : 0.5) * exact_cos((2 * x + 1) * u * kPi / 16);
  }
};

// cosine * block * cosine^T.
Block dct(const Block& block, const Block& cosine) {
  Block along{}, out{};
  for (size_t y = 0; y < 8; ++y)
    for (size_t u = 0; u < 8; ++u)
      for (size_t x = 0; x < 8; ++x) along[8 * y + u] += cosine[8 * u + x] * block[8 * y + x];
  for (size_t v = 0; v < 8; ++v)
    for (size_t y = 0; y < 8; ++y)
      for (size_t u = 0; u < 8; ++u) out[8 * v + u] += cosine[8 * v + y] * along[8 * y + u];
  return out;
}

Block load(PlaneView<const uint8_t> image, int left, int top) {
  Block block;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      block[static_cast<size_t>(kSide * y + x)] =
          *image.pixel(std::min(left + x, image.width - 1), std::min(top + y, image.height - 1));
  return block;
}

// n times the (n - 1)-normalized variance of the n = width * height samples at (left, top).
double spread(const Block& block, size_t left, size_t top, size_t side) {
  double sum = 0, squares = 0;
  for (size_t y = top; y < top + side; ++y)
    for (size_t x = left; x < left + side; ++x) {
      const double sample = block[8 * y + x];  // an integer: the sums are exact
      sum += sample;
      squares += sample * sample;
    }
  const auto n = static_cast<double>(side * side);
  return (squares - sum * sum / n) * n / (n - 1);
}

// How much texture masks: the energy of the AC coefficients, less where it comes from an edge between flat quarters
// rather than from texture in each of them.
double masking_of(const Block& block, const Block& coefficients, const Block& table) {
  double energy = 0;
  for (size_t i = 1; i < kSize; ++i) energy += coefficients[i] * coefficients[i] * table[i];
  const double whole = spread(block, 0, 0, 8);
  if (!(whole > 0)) return 0;
  const double quarters =
      spread(block, 0, 0, 4) + spread(block, 4, 0, 4) + spread(block, 0, 4, 4) + spread(block, 4, 4, 4);
  return std::sqrt(energy * (quarters / whole)) / 32;
}

}  // namespace

PsnrHvs psnr_hvs(PlaneView<const uint8_t> reference, PlaneView<const uint8_t> test) {
  PAC_ASSERT(!reference.empty() && reference.width == test.width && reference.height == test.height);
  const Tables tables;
  const int width = std::max(reference.width, kSide), height = std::max(reference.height, kSide);
  double sum = 0, masked_sum = 0, n = 0;
  for (int top = 0; top + kSide <= height; top += kSide)
    for (int left = 0; left + kSide <= width; left += kSide) {
      n += static_cast<double>(kSize);
      const Block a = load(reference, left, top), b = load(test, left, top);
      if (a == b) continue;
      const Block dct_a = dct(a, tables.cosine), dct_b = dct(b, tables.cosine);
      const double mask = std::max(masking_of(a, dct_a, tables.masking), masking_of(b, dct_b, tables.masking));
      for (size_t i = 0; i < kSize; ++i) {
        const double error = std::abs(dct_a[i] - dct_b[i]);
        const double visible = i == 0 ? error : std::max(0.0, error - mask / tables.masking[i]);
        sum += (error * tables.sensitivity[i]) * (error * tables.sensitivity[i]);
        masked_sum += (visible * tables.sensitivity[i]) * (visible * tables.sensitivity[i]);
      }
    }
  return {psnr_from_mse(sum / n), psnr_from_mse(masked_sum / n)};
}

PsnrHvs psnr_hvs_luma(ConstRgbView reference, ConstRgbView test) {
  const GrayImage a = luma_of(reference), b = luma_of(test);
  return psnr_hvs(a.view(), b.view());
}

}  // namespace pac
