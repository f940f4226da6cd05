// Errors, entropies and maps; the structural metrics are in ssim.cpp.
#include "base/metrics.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <span>
#include <vector>

#include "base/exact_math.h"
#include "base/flip.h"
#include "base/psnr_hvs.h"
#include "base/ssimulacra2.h"

namespace pac {
namespace {

template <int kChannels>
void assert_comparable(ImageView<const uint8_t, kChannels> a, ImageView<const uint8_t, kChannels> b) {
  PAC_ASSERT(!a.empty() && a.width == b.width && a.height == b.height);
}

// At most 2^31 * 2^31 samples of 255^2 would overflow; Limits keeps pictures far below.
template <int kChannels>
uint64_t sum_of_squares(ImageView<const uint8_t, kChannels> a, ImageView<const uint8_t, kChannels> b) {
  assert_comparable(a, b);
  constexpr int kRun = 1 << 15;  // 2^15 * 255^2 < 2^31
  const int n = a.width * kChannels;
  uint64_t total = 0;
  for (int y = 0; y < a.height; ++y) {
    const uint8_t* p = a.row(y);
    const uint8_t* q = b.row(y);
    for (int start = 0; start < n; start += kRun) {
      int sum = 0;
      for (int i = start; i < std::min(n, start + kRun); ++i) sum += (p[i] - q[i]) * (p[i] - q[i]);
      total += static_cast<uint64_t>(sum);
    }
  }
  return total;
}

template <int kChannels>
double mse(ImageView<const uint8_t, kChannels> a, ImageView<const uint8_t, kChannels> b) {
  const double n_samples = static_cast<double>(a.width) * a.height * kChannels;
  return static_cast<double>(sum_of_squares(a, b)) / n_samples;
}

constexpr double kLog2E = 1.44269504088896340736;
constexpr double kLog10E = 0.43429448190325182765;

// log2 n - (sum c log2 c) / n, summed in the order of the symbols: no division by n in each term.
double entropy_of_counts(std::span<const uint64_t> counts) {
  double n = 0, sum = 0;
  for (uint64_t count : counts) {
    if (count == 0) continue;
    const auto c = static_cast<double>(count);
    n += c;
    sum += c * exact_log(c);
  }
  return n > 0 ? std::max(0.0, (exact_log(n) - sum / n) * kLog2E) : 0.0;
}

double entropy_of_channel(const uint8_t* first, int width, int height, ptrdiff_t stride, int step) {
  std::vector<uint64_t> counts(256, 0);
  for (int y = 0; y < height; ++y) {
    const uint8_t* row = first + y * stride;
    for (int x = 0; x < width; ++x) ++counts[row[ptrdiff_t{x} * step]];
  }
  return entropy_of_counts(counts);
}

}  // namespace

GrayImage luma_of(ConstRgbView image) {
  GrayImage luma(image.width, image.height);
  for (int y = 0; y < image.height; ++y) {
    const uint8_t* from = image.row(y);
    uint8_t* to = luma.row(y);
    for (int x = 0; x < image.width; ++x, from += 3) to[x] = luma_bt601(from[0], from[1], from[2]);
  }
  return luma;
}

double mean_squared_error(ConstRgbView reference, ConstRgbView test) {
  return mse(reference, test);
}
double mean_squared_error(PlaneView<const uint8_t> reference, PlaneView<const uint8_t> test) {
  return mse(reference, test);
}
double rms_error(ConstRgbView reference, ConstRgbView test) {
  return std::sqrt(mse(reference, test));
}

double psnr_from_mse(double mse) {
  if (!(mse > 0)) return std::numeric_limits<double>::infinity();
  return 10.0 * kLog10E * exact_log(255.0 * 255.0 / mse);
}
double psnr_rgb(ConstRgbView reference, ConstRgbView test) {
  return psnr_from_mse(mse(reference, test));
}
double psnr_luma(ConstRgbView reference, ConstRgbView test) {
  const GrayImage a = luma_of(reference), b = luma_of(test);
  return psnr_from_mse(mse(a.view(), b.view()));
}

double entropy(PlaneView<const uint8_t> image) {
  return entropy_of_channel(image.data, image.width, image.height, image.stride, 1);
}
double entropy_per_channel(ConstRgbView image) {
  double sum = 0;
  for (int c = 0; c < 3; ++c) sum += entropy_of_channel(image.data + c, image.width, image.height, image.stride, 3);
  return sum / 3;
}
double entropy_luma(ConstRgbView image) {
  return entropy(luma_of(image).view());
}

double entropy_joint(ConstRgbView image) {
  std::vector<uint32_t> colors;
  colors.reserve(static_cast<size_t>(image.width) * static_cast<size_t>(image.height));
  for (int y = 0; y < image.height; ++y) {
    const uint8_t* p = image.row(y);
    for (int x = 0; x < image.width; ++x, p += 3)
      colors.push_back(uint32_t{p[0]} << 16 | uint32_t{p[1]} << 8 | uint32_t{p[2]});
  }
  std::sort(colors.begin(), colors.end());
  std::vector<uint64_t> counts;
  for (size_t i = 0; i < colors.size(); ++i) {
    if (i == 0 || colors[i] != colors[i - 1]) counts.push_back(0);
    ++counts.back();
  }
  return entropy_of_counts(counts);
}

double compression_ratio(int width, int height, uint64_t size_bytes) {
  PAC_ASSERT(size_bytes >= 1);
  return 3.0 * width * height / static_cast<double>(size_bytes);
}

double flicker_rms(PlaneView<const uint8_t> previous_reference, PlaneView<const uint8_t> reference,
                   PlaneView<const uint8_t> previous_test, PlaneView<const uint8_t> test) {
  assert_comparable(reference, test);
  assert_comparable(previous_reference, previous_test);
  assert_comparable(reference, previous_reference);
  uint64_t squares = 0;
  for (int y = 0; y < test.height; ++y)
    for (int x = 0; x < test.width; ++x) {
      const int change = *reference.pixel(x, y) - *previous_reference.pixel(x, y);
      const int error = *test.pixel(x, y) - *previous_test.pixel(x, y) - change;
      squares += static_cast<uint64_t>(error * error);
    }
  return std::sqrt(static_cast<double>(squares) / (static_cast<double>(test.width) * test.height));
}

Metrics measure(ConstRgbView reference, ConstRgbView test, ThreadPool* pool) {
  Metrics metrics;
  const double mse_rgb = mse(reference, test);
  metrics.rms = std::sqrt(mse_rgb);
  metrics.psnr_rgb_db = psnr_from_mse(mse_rgb);
  const GrayImage a = luma_of(reference), b = luma_of(test);
  metrics.psnr_luma_db = psnr_from_mse(mse(a.view(), b.view()));
  const PsnrHvs hvs = psnr_hvs(a.view(), b.view());
  metrics.psnr_hvs_db = hvs.psnr_hvs_db;
  metrics.psnr_hvs_m_db = hvs.psnr_hvs_m_db;
  metrics.ssimulacra2 = ssimulacra2(reference, test, pool);
  metrics.flip = flip(reference, test, pool);
  metrics.ssim = ssim(a.view(), b.view());
  metrics.ms_ssim = ms_ssim(a.view(), b.view());
  for (int y = 0; y < reference.height; ++y)
    for (int i = 0; i < reference.width * 3; ++i)
      metrics.max_error = std::max(metrics.max_error, std::abs(reference.row(y)[i] - test.row(y)[i]));
  return metrics;
}

RgbImage error_map(ConstRgbView reference, ConstRgbView test, int gain) {
  assert_comparable(reference, test);
  RgbImage map(reference.width, reference.height);
  for (int y = 0; y < reference.height; ++y)
    for (int i = 0; i < reference.width * 3; ++i)
      map.row(y)[i] =
          static_cast<uint8_t>(std::min<int64_t>(255, int64_t{gain} * std::abs(reference.row(y)[i] - test.row(y)[i])));
  return map;
}

}  // namespace pac
