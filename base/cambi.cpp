#include "base/cambi.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <vector>

#include "base/exact_math.h"
#include "base/metrics.h"

namespace pac {
namespace {

using Plane16 = Image<uint16_t, 1>;  // ten-bit luma

constexpr int kContrasts = 4;  // steps of 1, 2, 3, 4 levels; their weights are the same numbers
constexpr int kMaxLevel = 1023;

// The ten-bit levels of black and white.
struct Levels {
  int black, white;
};

// Light of a level on a display of 0.01 to 300 cd/m^2 [BT.1886].
double luminance(int level, Levels levels) {
  constexpr double kGamma = 2.4, kWhite = 300, kBlack = 0.01;
  const double white = exact_pow(kWhite, 1 / kGamma), black = exact_pow(kBlack, 1 / kGamma);
  const int clamped = std::clamp(level, levels.black, levels.white);
  const double v = static_cast<double>(clamped - levels.black) / (levels.white - levels.black);
  return exact_pow((white - black) * v + black, kGamma);
}

// Per contrast, the highest level at which such a step is visible: over 1.9 % of the luminance there.
std::array<int, kContrasts> visible_up_to(Levels levels) {
  std::array<int, kContrasts> limits{};
  for (int contrast = 1; contrast <= kContrasts; ++contrast) {
    const auto is_visible = [&](int level) {
      const double light = luminance(level, levels);
      return luminance(level + contrast, levels) - light > 0.019 * light;
    };
    int level = levels.white - contrast - 1;
    while (level > levels.black && !is_visible(level)) --level;
    limits[static_cast<size_t>(contrast - 1)] = level;
  }
  return limits;
}

// Ten bits, and the mean with the neighbors right and below: dithering becomes smooth.
Plane16 ten_bits(PlaneView<const uint8_t> luma) {
  Plane16 out(luma.width, luma.height);
  for (int y = 0; y < luma.height; ++y)
    for (int x = 0; x < luma.width; ++x) {
      const bool has_right = x + 1 < luma.width, has_below = y + 1 < luma.height;
      int sum = *luma.pixel(x, y) * 4, n = 1;
      if (has_right) sum += *luma.pixel(x + 1, y) * 4, ++n;
      if (has_below) sum += *luma.pixel(x, y + 1) * 4, ++n;
      if (has_right && has_below) sum += *luma.pixel(x + 1, y + 1) * 4, ++n;
      *out.pixel(x, y) = static_cast<uint16_t>(sum / n);
    }
  return out;
}

int ceil_log2(int n) {
  int shift = 0;
  while ((1 << shift) < n) ++shift;
  return shift;
}

// 1 where more than about half of the 7x7 pixels around equal their right and lower neighbors: surroundings without
// texture. Pixels outside do not count.
GrayImage flat_mask(const Plane16& image) {
  constexpr int kReach = 3;
  const int width = image.width(), height = image.height();
  std::vector<int> sums(static_cast<size_t>(width + 1) * static_cast<size_t>(height + 1));  // summed-area table
  const auto at = [&](int x, int y) -> int& {
    return sums[static_cast<size_t>(y) * static_cast<size_t>(width + 1) + static_cast<size_t>(x)];
  };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const uint16_t level = *image.pixel(x, y);
      const bool is_flat =
          (x + 1 == width || level == *image.pixel(x + 1, y)) && (y + 1 == height || level == *image.pixel(x, y + 1));
      at(x + 1, y + 1) = at(x, y + 1) + at(x + 1, y) - at(x, y) + (is_flat ? 1 : 0);
    }
  const int threshold = (49 + 3 * (ceil_log2((width / 64) * (height / 64)) - 11) - 1) >> 1;
  GrayImage mask(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const int left = std::max(x - kReach, 0), right = std::min(x + kReach + 1, width);
      const int top = std::max(y - kReach, 0), bottom = std::min(y + kReach + 1, height);
      *mask.pixel(x, y) = at(right, bottom) - at(left, bottom) - at(right, top) + at(left, top) > threshold;
    }
  return mask;
}

// Every second sample of every second row.
template <class T>
Image<T, 1> decimate(const Image<T, 1>& image) {
  Image<T, 1> half((image.width() + 1) / 2, (image.height() + 1) / 2);
  for (int y = 0; y < half.height(); ++y)
    for (int x = 0; x < half.width(); ++x) *half.pixel(x, y) = *image.pixel(2 * x, 2 * y);
  return half;
}

// The value that two of the three have, else the least.
uint16_t mode(uint16_t a, uint16_t b, uint16_t c) {
  if (a == b || a == c) return a;
  return b == c ? b : std::min({a, b, c});
}

// The mode of three along, then of three down; the first and last row stay.
void filter_mode(Plane16& image) {
  const int width = image.width(), height = image.height();
  Plane16 along(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const uint16_t* p = image.pixel(x, y);
      *along.pixel(x, y) = x == 0 || x + 1 == width ? *p : mode(p[-1], p[0], p[1]);
    }
  for (int y = 1; y + 1 < height; ++y)
    for (int x = 0; x < width; ++x)
      *image.pixel(x, y) = mode(*along.pixel(x, y - 1), *along.pixel(x, y), *along.pixel(x, y + 1));
}

// Counts of the flat pixels of each level in a window that slides along a row.
class WindowCounts {
 public:
  WindowCounts(const Plane16& image, const GrayImage& mask)
      : image_(image), mask_(mask), counts_(kMaxLevel + 1 + 2 * kContrasts) {}
  void clear() { std::fill(counts_.begin(), counts_.end(), 0); }
  // Column x of rows [top, bottom) enters (by = 1) or leaves (by = -1); columns outside are empty.
  void add_column(int x, int top, int bottom, int by) {
    if (x < 0 || x >= image_.width()) return;
    for (int y = top; y < bottom; ++y)
      if (*mask_.pixel(x, y) != 0) counts_[static_cast<size_t>(*image_.pixel(x, y) + kContrasts)] += by;
  }
  int of(int level) const { return counts_[static_cast<size_t>(level + kContrasts)]; }

 private:
  const Plane16& image_;
  const GrayImage& mask_;
  std::vector<int> counts_;
};

double contrast_confidence(const WindowCounts& counts, int level, const std::array<int, kContrasts>& limits) {
  double largest = 0;
  const int same = counts.of(level);
  for (int contrast = 1; contrast <= kContrasts; ++contrast) {
    if (level > limits[static_cast<size_t>(contrast - 1)]) continue;
    const int other = std::max(counts.of(level + contrast), counts.of(level - contrast));
    largest = std::max(largest, static_cast<double>(contrast * same * other) / (same + other));
  }
  return largest;
}

// The mean of the largest 60 %: those above the least of them, in the order of the pixels, then as many of it as lack.
double pool(const std::vector<double>& values) {
  const auto n = std::max<size_t>(1, static_cast<size_t>(0.6 * static_cast<double>(values.size())));
  std::vector<double> order = values;
  const auto least = order.begin() + static_cast<ptrdiff_t>(n) - 1;
  std::nth_element(order.begin(), least, order.end(), std::greater<>());
  double sum = 0;
  size_t n_above = 0;
  for (const double value : values)
    if (value > *least) {
      sum += value;
      ++n_above;
    }
  return (sum + static_cast<double>(n - n_above) * *least) / static_cast<double>(n);
}

double score_of_scale(const Plane16& image, const GrayImage& mask, int reach,
                      const std::array<int, kContrasts>& limits) {
  const int width = image.width(), height = image.height();
  WindowCounts counts(image, mask);
  std::vector<double> values(static_cast<size_t>(width) * static_cast<size_t>(height));
  for (int y = 0; y < height; ++y) {
    const int top = std::max(y - reach, 0), bottom = std::min(y + reach + 1, height);
    counts.clear();
    for (int x = 0; x < reach; ++x) counts.add_column(x, top, bottom, 1);
    for (int x = 0; x < width; ++x) {
      counts.add_column(x + reach, top, bottom, 1);
      counts.add_column(x - reach - 1, top, bottom, -1);
      if (*mask.pixel(x, y) != 0)
        values[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)] =
            contrast_confidence(counts, *image.pixel(x, y), limits);
    }
  }
  return pool(values);
}

}  // namespace

double cambi(PlaneView<const uint8_t> luma, LumaRange range) {
  PAC_ASSERT(!luma.empty());
  const std::array<int, kContrasts> limits =
      visible_up_to(range == LumaRange::full ? Levels{0, kMaxLevel} : Levels{64, 940});
  Plane16 image = ten_bits(luma);
  GrayImage mask = flat_mask(image);
  const int window = (65 * (luma.width + luma.height) / 375 >> 4) | 1;  // 65 pixels on a 3840x2160 picture
  double score = 0;
  for (int scale = 0; scale < 5; ++scale) {
    if (scale > 0) {
      image = decimate(image);
      mask = decimate(mask);
    }
    filter_mode(image);
    score += (16 >> scale) * score_of_scale(image, mask, window / 2, limits);
  }
  return score / (static_cast<double>(window) * window);
}

double cambi_luma(ConstRgbView image) {
  return cambi(luma_of(image).view());
}

}  // namespace pac
