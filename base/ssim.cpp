// SSIM and MS-SSIM. The Gaussian window is separable: each row of windows filters eleven rows downwards, then along.
#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "base/exact_math.h"
#include "base/metrics.h"

namespace pac {
namespace {

constexpr int kTaps = 11;
constexpr double kSigma = 1.5;
constexpr double kC1 = (0.01 * 255) * (0.01 * 255), kC2 = (0.03 * 255) * (0.03 * 255);

// exp(-d^2 / 2 sigma^2), normalized; n odd.
std::vector<double> gaussian(int n) {
  std::vector<double> taps(static_cast<size_t>(n));
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    const double d = i - n / 2;
    taps[static_cast<size_t>(i)] = exact_exp(-d * d / (2 * kSigma * kSigma));
    sum += taps[static_cast<size_t>(i)];
  }
  for (double& tap : taps) tap /= sum;
  return taps;
}

int taps_for(int side) {
  return std::min(kTaps, side % 2 == 0 ? side - 1 : side);
}

// The four weighted means that SSIM needs, for one row of windows or of columns. The sum of variances suffices, since
// the two variances occur only added.
struct Moments {
  std::vector<double> a, b, squares, product;  // E[a], E[b], E[a^2 + b^2], E[ab]
  explicit Moments(size_t n) : a(n), b(n), squares(n), product(n) {}
};

void filter_down(PlaneView<const uint8_t> a, PlaneView<const uint8_t> b, int top, const std::vector<double>& taps,
                 Moments& columns) {
  for (std::vector<double>* sums : {&columns.a, &columns.b, &columns.squares, &columns.product})
    std::fill(sums->begin(), sums->end(), 0.0);
  const auto width = static_cast<size_t>(a.width);
  double* const sum_a = columns.a.data();
  double* const sum_b = columns.b.data();
  double* const sum_squares = columns.squares.data();
  double* const sum_product = columns.product.data();
  for (size_t k = 0; k < taps.size(); ++k) {
    const uint8_t* p = a.row(top + static_cast<int>(k));
    const uint8_t* q = b.row(top + static_cast<int>(k));
    const double tap = taps[k];
    for (size_t x = 0; x < width; ++x) {
      const int s = p[x], t = q[x];
      sum_a[x] += tap * s;
      sum_b[x] += tap * t;
      sum_squares[x] += tap * (s * s + t * t);
      sum_product[x] += tap * (s * t);
    }
  }
}

void filter_along(const std::vector<double>& columns, const std::vector<double>& taps, std::vector<double>& windows) {
  const double* const from = columns.data();
  double* const to = windows.data();
  const size_t n = windows.size();
  for (size_t x = 0; x < n; ++x) to[x] = taps[0] * from[x];
  for (size_t k = 1; k < taps.size(); ++k)
    for (size_t x = 0; x < n; ++x) to[x] += taps[k] * from[x + k];
}

struct Similarity {
  double ssim = 0;
  double contrast_structure = 0;  // without the factor of the means
};

// Calls use(x, y, Similarity) for every window, in rows.
template <class Use>
void for_each_window(PlaneView<const uint8_t> a, PlaneView<const uint8_t> b, Use&& use) {
  PAC_ASSERT(!a.empty() && a.width == b.width && a.height == b.height);
  const std::vector<double> down = gaussian(taps_for(a.height)), along = gaussian(taps_for(a.width));
  const size_t n_windows = static_cast<size_t>(a.width) - along.size() + 1;
  Moments columns(static_cast<size_t>(a.width)), windows(n_windows);
  for (int y = 0; y + static_cast<int>(down.size()) <= a.height; ++y) {
    filter_down(a, b, y, down, columns);
    filter_along(columns.a, along, windows.a);
    filter_along(columns.b, along, windows.b);
    filter_along(columns.squares, along, windows.squares);
    filter_along(columns.product, along, windows.product);
    for (size_t x = 0; x < n_windows; ++x) {
      const double mean_a = windows.a[x], mean_b = windows.b[x];
      const double squares_of_means = mean_a * mean_a + mean_b * mean_b, product_of_means = mean_a * mean_b;
      const double variances = windows.squares[x] - squares_of_means;
      const double covariance = windows.product[x] - product_of_means;
      const double contrast_structure = (2 * covariance + kC2) / (variances + kC2);
      const double means = (2 * product_of_means + kC1) / (squares_of_means + kC1);
      use(static_cast<int>(x), y, Similarity{means * contrast_structure, contrast_structure});
    }
  }
}

Similarity mean_similarity(PlaneView<const uint8_t> a, PlaneView<const uint8_t> b) {
  Similarity total;
  double n = 0;
  for_each_window(a, b, [&](int, int, const Similarity& s) {
    total.ssim += s.ssim;
    total.contrast_structure += s.contrast_structure;
    n += 1;
  });
  return {total.ssim / n, total.contrast_structure / n};
}

GrayImage halve(PlaneView<const uint8_t> image) {
  GrayImage half(image.width / 2, image.height / 2);
  for (int y = 0; y < half.height(); ++y)
    for (int x = 0; x < half.width(); ++x) {
      const uint8_t* top = image.pixel(2 * x, 2 * y);
      const uint8_t* bottom = image.pixel(2 * x, 2 * y + 1);
      *half.pixel(x, y) = static_cast<uint8_t>((top[0] + top[1] + bottom[0] + bottom[1] + 2) / 4);
    }
  return half;
}

}  // namespace

double ssim(PlaneView<const uint8_t> reference, PlaneView<const uint8_t> test) {
  return mean_similarity(reference, test).ssim;
}

double ssim_luma(ConstRgbView reference, ConstRgbView test) {
  const GrayImage a = luma_of(reference), b = luma_of(test);
  return ssim(a.view(), b.view());
}

DepthImage ssim_map(PlaneView<const uint8_t> reference, PlaneView<const uint8_t> test) {
  DepthImage map(reference.width - taps_for(reference.width) + 1, reference.height - taps_for(reference.height) + 1);
  for_each_window(reference, test,
                  [&](int x, int y, const Similarity& s) { *map.pixel(x, y) = static_cast<float>(s.ssim); });
  return map;
}

double ms_ssim(PlaneView<const uint8_t> reference, PlaneView<const uint8_t> test) {
  constexpr std::array<double, 5> kExponents{0.0448, 0.2856, 0.3001, 0.2363, 0.1333};
  size_t n_scales = 1;
  double exponent_sum = kExponents[0];
  for (int side = std::min(reference.width, reference.height) / 2; n_scales < kExponents.size() && side >= kTaps;
       side /= 2)
    exponent_sum += kExponents[n_scales++];
  if (n_scales == kExponents.size()) exponent_sum = 1;  // the paper's own, though they sum to 1.0001
  double product = 1;
  GrayImage a, b;  // own what the views show from the second scale on
  for (size_t scale = 0; scale < n_scales; ++scale) {
    const Similarity mean = mean_similarity(reference, test);
    const bool is_last = scale + 1 == n_scales;
    product *= exact_pow(is_last ? mean.ssim : mean.contrast_structure, kExponents[scale] / exponent_sum);
    if (is_last) break;
    a = halve(reference);
    b = halve(test);
    reference = a.view();
    test = b.view();
  }
  return product;
}

double ms_ssim_luma(ConstRgbView reference, ConstRgbView test) {
  const GrayImage a = luma_of(reference), b = luma_of(test);
  return ms_ssim(a.view(), b.view());
}

}  // namespace pac
