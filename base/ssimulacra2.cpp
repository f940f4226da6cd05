#include "base/ssimulacra2.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "base/exact_math.h"
#include "base/exact_math_float.h"
#include "base/parallel.h"
#include "base/ssimulacra2_weights.h"

namespace pac {
namespace {

using Plane = Image<float, 1>;
using ConstPlaneView = PlaneView<const float>;

constexpr size_t kMaxScales = 6;
constexpr int kMinSide = 8;
constexpr float kC2 = 0.0009f;  // keeps SSIM's quotient steady where both pictures are flat

// ---- XYB -----------------------------------------------------------------------------------------------------------

// Linear light of the 256 sRGB codes.
struct LinearTable {
  std::array<float, 256> value;
  LinearTable() {
    for (size_t i = 0; i < 256; ++i) value[i] = static_cast<float>(linear_from_srgb(static_cast<double>(i) / 255));
  }
};

// Red, green and blue in linear light.
struct Linear {
  Plane channel[3];
  Linear(int width, int height) : channel{Plane(width, height), Plane(width, height), Plane(width, height)} {}
  int width() const { return channel[0].width(); }
  int height() const { return channel[0].height(); }
};

Linear linear_light(ConstRgbView image) {
  const LinearTable table;
  Linear linear(std::max(image.width, kMinSide), std::max(image.height, kMinSide));
  for (int y = 0; y < linear.height(); ++y)
    for (int x = 0; x < linear.width(); ++x) {
      const uint8_t* pixel = image.pixel(std::min(x, image.width - 1), std::min(y, image.height - 1));
      for (int c = 0; c < 3; ++c) *linear.channel[c].pixel(x, y) = table.value[pixel[c]];
    }
  return linear;
}

// 2x2 means; an odd last row or column counts twice.
Plane halve(const Plane& plane) {
  Plane half((plane.width() + 1) / 2, (plane.height() + 1) / 2);
  for (int y = 0; y < half.height(); ++y) {
    const float* top = plane.row(2 * y);
    const float* bottom = plane.row(std::min(2 * y + 1, plane.height() - 1));
    float* to = half.row(y);
    for (int x = 0; x < plane.width() / 2; ++x)
      to[x] = (((top[2 * x] + top[2 * x + 1]) + bottom[2 * x]) + bottom[2 * x + 1]) * 0.25f;
    if (plane.width() % 2 != 0) {
      const int last = plane.width() - 1;
      to[half.width() - 1] = (((top[last] + top[last]) + bottom[last]) + bottom[last]) * 0.25f;
    }
  }
  return half;
}

// Cone responses: opsin absorbance matrix and bias of JPEG XL [18181-1 L.2.2], then XYB, then the offsets and factors
// that bring every channel into about 0..1 (SSIM's terms need that).
void xyb_row(const float* red, const float* green, const float* blue, int width, float* out_x, float* out_y,
             float* out_b) {
  constexpr float kBias = 0.0037930732552754493f;
  constexpr float kCubeRootOfBias = 0.15595420054924863f;
  for (int i = 0; i < width; ++i) {
    const float r = red[i], g = green[i], b = blue[i];
    const float l = exact_cube_root(0.30f * r + (0.622f * g + (0.078f * b + kBias))) - kCubeRootOfBias;
    const float m = exact_cube_root(0.23f * r + (0.692f * g + (0.078f * b + kBias))) - kCubeRootOfBias;
    const float s =
        exact_cube_root(0.24342268924547819f * r + (0.20476744424496821f * g + (0.55180986650955360f * b + kBias))) -
        kCubeRootOfBias;
    const float luma = 0.5f * (l + m);
    out_x[i] = 0.5f * (l - m) * 14.0f + 0.42f;
    out_y[i] = luma + 0.01f;
    out_b[i] = (s - luma) + 0.55f;
  }
}

Ssimulacra2::Xyb xyb_of(const Linear& linear) {
  const int width = linear.width(), height = linear.height();
  Ssimulacra2::Xyb xyb{{Plane(width, height), Plane(width, height), Plane(width, height)}};
  for (int y = 0; y < height; ++y)
    xyb_row(linear.channel[0].row(y), linear.channel[1].row(y), linear.channel[2].row(y), width, xyb.channel[0].row(y),
            xyb.channel[1].row(y), xyb.channel[2].row(y));
  return xyb;
}

// Another scale follows while the last one had both sides of kMinSide and more.
std::vector<Ssimulacra2::Xyb> xyb_pyramid(ConstRgbView image) {
  Linear linear = linear_light(image);
  std::vector<Ssimulacra2::Xyb> scales;
  while (true) {
    scales.push_back(xyb_of(linear));
    if (scales.size() == kMaxScales || linear.width() < kMinSide || linear.height() < kMinSide) return scales;
    for (Plane& channel : linear.channel) channel = halve(channel);
  }
}

// ---- Gaussian window -----------------------------------------------------------------------------------------------

// Charalampidis' recursive Gaussian [IEEE Trans. Signal Processing 64 (14), 2016] with sigma 1.5 and N = 5. Its impulse
// response is sum_k beta_k cos(k pi n / 10), k = 1, 3, 5, cut off at |n| = 5, where each cosine is 0: nine taps.
// Applied as such it gathers no rounding errors along a row and works on all columns at once; outside the picture there
// are zeros, as in the recursive form.
constexpr int kReach = 4;
constexpr float kTaps[kReach + 1] = {0.26462110548819856f, 0.2129285920104222f, 0.10933537277746029f,
                                     0.03601111465836437f, 0.009414367809653733f};

// in: kReach readable elements before and after the row's.
void filter_along(const float* in, int width, float* out) {
  for (int x = 0; x < width; ++x)
    out[x] = kTaps[0] * in[x] + kTaps[1] * (in[x - 1] + in[x + 1]) + kTaps[2] * (in[x - 2] + in[x + 2]) +
             kTaps[3] * (in[x - 3] + in[x + 3]) + kTaps[4] * (in[x - 4] + in[x + 4]);
}

// rows: the nine rows from y - kReach to y + kReach.
void filter_down(const std::array<const float*, 2 * kReach + 1>& rows, int width, float* out) {
  const auto [a4, a3, a2, a1, center, b1, b2, b3, b4] = rows;
  for (int x = 0; x < width; ++x)
    out[x] = kTaps[0] * center[x] + kTaps[1] * (a1[x] + b1[x]) + kTaps[2] * (a2[x] + b2[x]) +
             kTaps[3] * (a3[x] + b3[x]) + kTaps[4] * (a4[x] + b4[x]);
}

// The four windowed means of rows of a and b that SSIM needs, filtered along; nine rows at a time in a ring. (The sum
// of the squares' means suffices, since the two variances occur only added.)
class WindowedRows {
 public:
  enum Mean : size_t { kA, kB, kSquares, kProduct, kMeans };

  WindowedRows(ConstPlaneView a, ConstPlaneView b)
      : a_(a), b_(b), ring_(a.width, kRows * static_cast<int>(kMeans)), padded_(a.width + 2 * kReach, 1) {}

  // Row y of the picture enters; y outside of it is a row of zeros. Rows must enter in order.
  void enter(int y) {
    const int width = a_.width;
    if (y < 0 || y >= a_.height) {
      for (size_t mean = 0; mean < kMeans; ++mean) std::fill_n(ring_row(y, mean), width, 0.0f);
      return;
    }
    const float* a = a_.row(y);
    const float* b = b_.row(y);
    float* const in = padded_.row(0) + kReach;
    std::copy_n(a, width, in);
    filter_along(in, width, ring_row(y, kA));
    std::copy_n(b, width, in);
    filter_along(in, width, ring_row(y, kB));
    for (int x = 0; x < width; ++x) in[x] = a[x] * a[x] + b[x] * b[x];
    filter_along(in, width, ring_row(y, kSquares));
    for (int x = 0; x < width; ++x) in[x] = a[x] * b[x];
    filter_along(in, width, ring_row(y, kProduct));
  }

  // The mean around each pixel of row y; rows y - kReach to y + kReach have entered last.
  void means(int y, Mean mean, float* out) {
    std::array<const float*, 2 * kReach + 1> rows;
    for (int k = 0; k <= 2 * kReach; ++k) rows[static_cast<size_t>(k)] = ring_row(y - kReach + k, mean);
    filter_down(rows, a_.width, out);
  }

 private:
  static constexpr int kRows = 2 * kReach + 1;
  float* ring_row(int y, size_t mean) {
    return ring_.row((y + kRows) % kRows * static_cast<int>(kMeans) + static_cast<int>(mean));
  }
  ConstPlaneView a_, b_;
  Plane ring_, padded_;
};

// ---- Error maps and their norms ------------------------------------------------------------------------------------

enum Map : size_t { kSsim, kRinging, kBlur, kMaps };

// Sums of errors and of their fourth powers, over some rows of a channel.
struct Sums {
  double first[kMaps] = {}, fourth[kMaps] = {};
  void add(const Sums& other) {
    for (size_t map = 0; map < kMaps; ++map) {
      first[map] += other.first[map];
      fourth[map] += other.fourth[map];
    }
  }
};

// Eight running sums, pixel x to number x % 8: a fixed order that also fills vectors.
void sum_row(const float* errors, int width, double& first, double& fourth) {
  constexpr int kLanes = 8;
  double lane_first[kLanes] = {}, lane_fourth[kLanes] = {};
  int x = 0;
  for (; x + kLanes <= width; x += kLanes)
    for (int lane = 0; lane < kLanes; ++lane) {
      const double error = static_cast<double>(errors[x + lane]), square = error * error;
      lane_first[lane] += error;
      lane_fourth[lane] += square * square;
    }
  for (; x < width; ++x) {
    const double error = static_cast<double>(errors[x]), square = error * error;
    lane_first[x % kLanes] += error;
    lane_fourth[x % kLanes] += square * square;
  }
  for (int lane = 0; lane < kLanes; ++lane) {
    first += lane_first[lane];
    fourth += lane_fourth[lane];
  }
}

// 1 - SSIM', where a = b exactly 0: then squares = 2 product to the last bit, and so are their means.
void ssim_errors(const float* mean_a, const float* mean_b, const float* squares, const float* product, int width,
                 float* errors) {
  for (int x = 0; x < width; ++x) {
    const float difference = mean_a[x] - mean_b[x];
    const float structure = 2 * (product[x] - mean_a[x] * mean_b[x]) + kC2;
    const float contrast = (squares[x] - (mean_a[x] * mean_a[x] + mean_b[x] * mean_b[x])) + kC2;
    errors[x] = std::max(1 - (1 - difference * difference) * structure / contrast, 0.0f);
  }
}

// Where the distance from the local mean is larger in the test b: ringing; where it is larger in the reference a: blur.
void edge_errors(const float* a, const float* b, const float* mean_a, const float* mean_b, int width, float* ringing,
                 float* blur) {
  for (int x = 0; x < width; ++x) {
    const float edge = (1 + std::abs(b[x] - mean_b[x])) / (1 + std::abs(a[x] - mean_a[x])) - 1;
    ringing[x] = std::max(edge, 0.0f);
    blur[x] = std::max(-edge, 0.0f);
  }
}

Sums errors_of_rows(ConstPlaneView a, ConstPlaneView b, int first_row, int end_row) {
  const int width = a.width;
  WindowedRows window(a, b);
  Plane scratch(width, 7);
  float* const mean_a = scratch.row(0);
  float* const mean_b = scratch.row(1);
  float* const squares = scratch.row(2);
  float* const product = scratch.row(3);
  float* const errors[kMaps] = {scratch.row(4), scratch.row(5), scratch.row(6)};
  Sums sums;
  for (int y = first_row - kReach; y < first_row + kReach; ++y) window.enter(y);
  for (int y = first_row; y < end_row; ++y) {
    window.enter(y + kReach);
    window.means(y, WindowedRows::kA, mean_a);
    window.means(y, WindowedRows::kB, mean_b);
    window.means(y, WindowedRows::kSquares, squares);
    window.means(y, WindowedRows::kProduct, product);
    ssim_errors(mean_a, mean_b, squares, product, width, errors[kSsim]);
    edge_errors(a.row(y), b.row(y), mean_a, mean_b, width, errors[kRinging], errors[kBlur]);
    for (size_t map = 0; map < kMaps; ++map) sum_row(errors[map], width, sums.first[map], sums.fourth[map]);
  }
  return sums;
}

// ---- Score ---------------------------------------------------------------------------------------------------------

// A piece of work: some rows of one channel of one scale. Pieces depend on the picture's size alone, and their sums are
// added in order: the threads that did them leave no trace.
struct Band {
  size_t scale, channel;
  int first_row, end_row;
};

std::vector<Band> bands_of(const std::vector<Ssimulacra2::Xyb>& scales) {
  constexpr int kBandRows = 128;
  std::vector<Band> bands;
  for (size_t scale = 0; scale < scales.size(); ++scale)
    for (size_t channel = 0; channel < 3; ++channel)
      for (int y = 0, height = scales[scale].channel[0].height(); y < height; y += kBandRows)
        bands.push_back({scale, channel, y, std::min(y + kBandRows, height)});
  return bands;
}

// The fitted curve from the weighted sum to the scale of people's votes.
double score_from_sum(double weighted_sum) {
  const double s = weighted_sum * 0.9562382616834844;
  const double curve = 2.326765642916932 * s - 0.020884521182843837 * s * s + 6.248496625763138e-05 * s * s * s;
  return curve > 0 ? 100 - 10 * exact_pow(curve, 0.6276336467831387) : 100.0;
}

}  // namespace

Ssimulacra2::Ssimulacra2(ConstRgbView reference) : width_(reference.width), height_(reference.height) {
  PAC_ASSERT(!reference.empty());
  scales_ = xyb_pyramid(reference);
}

double Ssimulacra2::score(ConstRgbView test, ThreadPool* pool) const {
  PAC_ASSERT(test.width == width_ && test.height == height_);
  const std::vector<Xyb> tests = xyb_pyramid(test);
  const std::vector<Band> bands = bands_of(scales_);
  std::vector<Sums> sums(bands.size());
  auto measure_band = [&](int64_t index) {
    const Band& band = bands[static_cast<size_t>(index)];
    sums[static_cast<size_t>(index)] =
        errors_of_rows(scales_[band.scale].channel[band.channel].view(), tests[band.scale].channel[band.channel].view(),
                       band.first_row, band.end_row);
  };
  const auto n_bands = static_cast<int64_t>(bands.size());
  if (pool != nullptr) {
    pool->for_each(n_bands, measure_band);
  } else {
    for (int64_t i = 0; i < n_bands; ++i) measure_band(i);
  }

  std::array<std::array<Sums, 3>, kMaxScales> totals;
  for (size_t i = 0; i < bands.size(); ++i) totals[bands[i].scale][bands[i].channel].add(sums[i]);
  double weighted_sum = 0;
  size_t weight = 0;  // pictures of fewer scales use the first weights of the table, as the reference program does
  for (size_t channel = 0; channel < 3; ++channel)
    for (size_t scale = 0; scale < scales_.size(); ++scale) {
      const Sums& total = totals[scale][channel];
      const Plane& plane = scales_[scale].channel[channel];
      const double n = static_cast<double>(plane.width()) * plane.height();
      for (size_t map = 0; map < kMaps; ++map) weighted_sum += kSsimulacra2Weights[weight++] * (total.first[map] / n);
      for (size_t map = 0; map < kMaps; ++map)
        weighted_sum += kSsimulacra2Weights[weight++] * std::sqrt(std::sqrt(total.fourth[map] / n));
    }
  return score_from_sum(weighted_sum);
}

double ssimulacra2(ConstRgbView reference, ConstRgbView test, ThreadPool* pool) {
  return Ssimulacra2(reference).score(test, pool);
}

}  // namespace pac
