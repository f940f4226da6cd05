// What a picture's DCT coefficients are like: their peaks, and what each quantizer step would cost each of them.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/exact_math.h"
#include "sim/table_family.h"

namespace pac::sim {

namespace {

// One component at its coded resolution, padded to whole blocks; samples are centered on zero.
struct Component {
  int width = 0, height = 0;  // multiples of 8
  std::vector<double> samples;

  Component(int w, int h)
      : width((w + 7) / 8 * 8),
        height((h + 7) / 8 * 8),
        samples(static_cast<size_t>(width) * static_cast<size_t>(height)) {}
  double& at(int x, int y) {
    return samples[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)];
  }
};

// JFIF's Y, Cb, Cr of one pixel, all centered on zero.
double color_component(const uint8_t* rgb, int component) {
  const double r = rgb[0], g = rgb[1], b = rgb[2];
  if (component == 0) return 0.299 * r + 0.587 * g + 0.114 * b - 128;
  if (component == 1) return -0.168736 * r - 0.331264 * g + 0.5 * b;
  return 0.5 * r - 0.418688 * g - 0.081312 * b;
}

// Means over x_factor x y_factor pixels; past the edge the last row and column repeat.
Component extract(ConstRgbView image, int component, int x_factor, int y_factor) {
  Component out((image.width + x_factor - 1) / x_factor, (image.height + y_factor - 1) / y_factor);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      double sum = 0;
      for (int j = 0; j < y_factor; ++j)
        for (int i = 0; i < x_factor; ++i)
          sum += color_component(
              image.pixel(std::min(x * x_factor + i, image.width - 1), std::min(y * y_factor + j, image.height - 1)),
              component);
      out.at(x, y) = sum / (x_factor * y_factor);
    }
  return out;
}

// cosines[u][x] of the orthonormal 8-point DCT-II.
struct Basis {
  double cosines[8][8];
  Basis() {
    for (int u = 0; u < 8; ++u)
      for (int x = 0; x < 8; ++x)
        cosines[u][x] = (u == 0 ? std::sqrt(0.125) : 0.5) * exact_cos((2 * x + 1) * u * kPi / 16);
  }
};

void transform(const Basis& basis, const double in[8][8], double out[8][8]) {
  double rows[8][8];
  for (int y = 0; y < 8; ++y)
    for (int u = 0; u < 8; ++u) {
      double sum = 0;
      for (int x = 0; x < 8; ++x) sum += in[y][x] * basis.cosines[u][x];
      rows[y][u] = sum;
    }
  for (int v = 0; v < 8; ++v)
    for (int u = 0; u < 8; ++u) {
      double sum = 0;
      for (int y = 0; y < 8; ++y) sum += rows[y][u] * basis.cosines[v][y];
      out[v][u] = sum;
    }
}

// The coefficients of every block of a component, in scan order: use(coefficients[v][u]).
template <class Use>
void for_each_block(Component& component, const Basis& basis, Use&& use) {
  for (int by = 0; by < component.height; by += 8)
    for (int bx = 0; bx < component.width; bx += 8) {
      double block[8][8], coefficients[8][8];
      for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x) block[y][x] = component.at(bx + x, by + y);
      transform(basis, block, coefficients);
      use(coefficients);
    }
}

// Y, then Cb and Cr where they are coded: use(component, is_chroma).
template <class Use>
void for_each_component(ConstRgbView image, jpeg::Subsampling subsampling, Use&& use) {
  const int x_factor = subsampling == jpeg::Subsampling::yuv444 ? 1 : 2;
  const int y_factor = subsampling == jpeg::Subsampling::yuv420 ? 2 : 1;
  Component luma = extract(image, 0, 1, 1);
  use(luma, false);
  for (int number = 1; number <= 2 && subsampling != jpeg::Subsampling::gray; ++number) {
    Component chroma = extract(image, number, x_factor, y_factor);
    use(chroma, true);
  }
}

// How often each value occurs, rounded to an integer (|coefficient| <= 1024, DC differences twice that), or what its
// errors count.
constexpr int kLargest = 2048;
using Histogram = std::vector<double>;  // index 0..2*kLargest: value + kLargest

struct Histograms {
  std::vector<Histogram> coefficient = std::vector<Histogram>(64, Histogram(2 * kLargest + 1));
  std::vector<Histogram> important;                 // the same, each block as often as it counts; empty: once
  Histogram dc_step = Histogram(2 * kLargest + 1);  // DC minus the DC of the block before

  // importance: of each block, empty: 1.
  void add(Component& component, const Basis& basis, const std::vector<float>& importance) {
    int last_dc = 0;
    size_t block = 0;
    if (!importance.empty()) important.resize(64, Histogram(2 * kLargest + 1));
    for_each_block(component, basis, [&](const double(&coefficients)[8][8]) {
      for (int k = 0; k < 64; ++k) {
        const size_t at = bin(rounded(coefficients[k / 8][k % 8]));
        coefficient[static_cast<size_t>(k)][at] += 1;
        if (!importance.empty()) important[static_cast<size_t>(k)][at] += static_cast<double>(importance[block]);
      }
      const int dc = rounded(coefficients[0][0]);
      dc_step[bin(dc - last_dc)] += 1;
      last_dc = dc;
      ++block;
    });
  }
  static int rounded(double value) { return static_cast<int>(std::floor(value + 0.5)); }
  static size_t bin(int value) { return static_cast<size_t>(std::clamp(value, -kLargest, kLargest) + kLargest); }
};

int level_of(int value, int step) {
  const int magnitude = (std::abs(value) + step / 2) / step;
  return value < 0 ? -magnitude : magnitude;
}

// The values that occur, ascending, with their counts: most of a histogram is empty.
struct Occurrence {
  int value = 0;
  double count = 0;
};

std::vector<Occurrence> occurrences(const Histogram& histogram) {
  std::vector<Occurrence> list;
  for (int value = -kLargest; value <= kLargest; ++value)
    if (const double count = histogram[static_cast<size_t>(value + kLargest)]; count > 0)
      list.push_back({value, count});
  return list;
}

double squared_error(const std::vector<Occurrence>& values, int step) {
  double sum = 0;
  for (const Occurrence& item : values) {
    const double error = item.value - level_of(item.value, step) * step;
    sum += item.count * error * error;
  }
  return sum;
}

// Entropy of the levels times their number: n log2 n - sum of c log2 c over the levels' counts c.
double level_bits(const std::vector<Occurrence>& values, int step) {
  double total = 0, sum = 0;
  for (size_t i = 0; i < values.size();) {
    const int level = level_of(values[i].value, step);
    double count = 0;
    for (; i < values.size() && level_of(values[i].value, step) == level; ++i) count += values[i].count;
    sum += count * exact_log(count);
    total += count;
  }
  return total > 0 ? (total * exact_log(total) - sum) / 0.69314718055994530942 : 0;
}

// From blocks of pixels to those of a component that has a sample for so many pixels: the mean.
std::vector<float> spread(std::span<const float> importance, ConstRgbView image, const Component& component) {
  std::vector<float> out;
  if (importance.empty()) return out;
  const int columns = (image.width + 7) / 8, rows = (image.height + 7) / 8;
  const int x_factor = component.width < 8 * columns ? 2 : 1, y_factor = component.height < 8 * rows ? 2 : 1;
  for (int top = 0; top < component.height / 8 * y_factor; top += y_factor)
    for (int left = 0; left < component.width / 8 * x_factor; left += x_factor) {
      float sum = 0;
      const int bottom = std::min(top + y_factor, rows), right = std::min(left + x_factor, columns);
      for (int y = top; y < bottom; ++y)
        for (int x = left; x < right; ++x) sum += importance[static_cast<size_t>(y * columns + x)];
      out.push_back(sum / static_cast<float>((bottom - top) * (right - left)));
    }
  return out;
}

void fill_costs(const Histograms& histograms, std::array<StepCosts, 64>& costs) {
  for (size_t k = 0; k < 64; ++k) {
    const std::vector<Occurrence> values = occurrences(histograms.coefficient[k]);
    const std::vector<Occurrence> coded = k == 0 ? occurrences(histograms.dc_step) : values;
    const std::vector<Occurrence> important =
        histograms.important.empty() ? values : occurrences(histograms.important[k]);
    for (int step = 1; step < 256; ++step) {
      costs[k].error[static_cast<size_t>(step)] = squared_error(important, step);
      costs[k].bits[static_cast<size_t>(step)] = level_bits(coded, step);
    }
  }
}

}  // namespace

CoefficientPeaks measure_peaks(ConstRgbView image, jpeg::Subsampling subsampling) {
  const Basis basis;
  CoefficientPeaks peaks;
  for_each_component(image, subsampling, [&](Component& component, bool is_chroma) {
    auto& peak = is_chroma ? peaks.chroma : peaks.luma;
    for_each_block(component, basis, [&](const double(&coefficients)[8][8]) {
      for (size_t k = 0; k < 64; ++k) peak[k] = std::max(peak[k], std::fabs(coefficients[k / 8][k % 8]));
    });
  });
  return peaks;
}

std::unique_ptr<PictureCosts> measure_costs(ConstRgbView image, jpeg::Subsampling subsampling,
                                            std::span<const float> importance) {
  const Basis basis;
  Histograms luma, chroma;
  for_each_component(image, subsampling, [&](Component& component, bool is_chroma) {
    (is_chroma ? chroma : luma).add(component, basis, spread(importance, image, component));
  });
  auto costs = std::make_unique<PictureCosts>();
  fill_costs(luma, costs->luma);
  fill_costs(chroma, costs->chroma);
  return costs;
}

}  // namespace pac::sim
