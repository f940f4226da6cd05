#include "base/flip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "base/exact_math.h"
#include "base/exact_math_float.h"
#include "base/magma.h"
#include "base/parallel.h"

namespace pac {
namespace {

using Plane = Image<float, 1>;

// ---- Color spaces --------------------------------------------------------------------------------------------------

// CIE XYZ of linear sRGB, every row divided by its sum: (1, 1, 1) is D65 white. The fractions are the exact solution of
// the primaries' chromaticities [IEC 61966-2-1].
constexpr double kXyzSums[3] = {10135552.0 + 8788810.0 + 4435075.0, 2613072.0 + 8788810.0 + 887015.0,
                                1425312.0 + 8788810.0 + 70074185.0};
constexpr float kXyzFromRgb[3][3] = {
    {static_cast<float>(10135552.0 / kXyzSums[0]), static_cast<float>(8788810.0 / kXyzSums[0]),
     static_cast<float>(4435075.0 / kXyzSums[0])},
    {static_cast<float>(2613072.0 / kXyzSums[1]), static_cast<float>(8788810.0 / kXyzSums[1]),
     static_cast<float>(887015.0 / kXyzSums[1])},
    {static_cast<float>(1425312.0 / kXyzSums[2]), static_cast<float>(8788810.0 / kXyzSums[2]),
     static_cast<float>(70074185.0 / kXyzSums[2])}};

// Its inverse, by cofactors.
struct RgbFromXyz {
  float row[3][3];
  RgbFromXyz() {
    const auto m = [](size_t i, size_t j) { return static_cast<double>(kXyzFromRgb[i % 3][j % 3]); };
    const auto cofactor = [&](size_t i, size_t j) {
      return m(i + 1, j + 1) * m(i + 2, j + 2) - m(i + 1, j + 2) * m(i + 2, j + 1);
    };
    const double determinant = m(0, 0) * cofactor(0, 0) + m(0, 1) * cofactor(0, 1) + m(0, 2) * cofactor(0, 2);
    for (size_t i = 0; i < 3; ++i)
      for (size_t j = 0; j < 3; ++j) row[i][j] = static_cast<float>(cofactor(j, i) / determinant);
  }
};

// The paper's YCxCz without its scales and offset, which cancel: y, x - y, y - z of white-normalized XYZ.
enum Opponent : size_t { kY, kCx, kCz, kOpponents };
struct OpponentPicture {
  std::array<Plane, kOpponents> plane;
};

OpponentPicture opponent_picture(ConstRgbView image) {
  std::array<float, 256> linear;
  for (size_t i = 0; i < 256; ++i) linear[i] = static_cast<float>(linear_from_srgb(static_cast<double>(i) / 255));
  OpponentPicture out;
  for (Plane& plane : out.plane) plane = Plane(image.width, image.height);
  for (int y = 0; y < image.height; ++y) {
    const uint8_t* pixel = image.row(y);
    for (int x = 0; x < image.width; ++x, pixel += 3) {
      const float r = linear[pixel[0]], g = linear[pixel[1]], b = linear[pixel[2]];
      float xyz[3];
      for (size_t i = 0; i < 3; ++i) xyz[i] = kXyzFromRgb[i][0] * r + kXyzFromRgb[i][1] * g + kXyzFromRgb[i][2] * b;
      *out.plane[kY].pixel(x, y) = xyz[1];
      *out.plane[kCx].pixel(x, y) = xyz[0] - xyz[1];
      *out.plane[kCz].pixel(x, y) = xyz[1] - xyz[2];
    }
  }
  return out;
}

struct Lab {
  float l, a, b;  // a, b after the Hunt adjustment: times l / 100
};

// CIELab's compression: cube root, linear near black.
inline float lab_compress(float t) {
  constexpr float kDelta = 6.0f / 29;
  constexpr float kCube = kDelta * kDelta * kDelta;
  const float root = exact_cube_root(t > kCube ? t : kCube);
  return t > kCube ? root : t * (1.0f / (3 * kDelta * kDelta)) + 4.0f / 29;
}

inline float clamp_unit(float v) {
  return v < 0 ? 0.0f : v > 1 ? 1.0f : v;
}

inline Lab hunt_lab_of_linear(float r, float g, float b) {
  const float fx = lab_compress(kXyzFromRgb[0][0] * r + kXyzFromRgb[0][1] * g + kXyzFromRgb[0][2] * b);
  const float fy = lab_compress(kXyzFromRgb[1][0] * r + kXyzFromRgb[1][1] * g + kXyzFromRgb[1][2] * b);
  const float fz = lab_compress(kXyzFromRgb[2][0] * r + kXyzFromRgb[2][1] * g + kXyzFromRgb[2][2] * b);
  const float l = 116 * fy - 16;
  return {l, 0.01f * l * (500 * (fx - fy)), 0.01f * l * (200 * (fy - fz))};
}

// HyAB: city block in lightness, Euclid in color.
inline float hyab(const Lab& p, const Lab& q) {
  const float da = p.a - q.a, db = p.b - q.b;
  return std::abs(p.l - q.l) + std::sqrt(da * da + db * db);
}

// ---- Filters -------------------------------------------------------------------------------------------------------

// One dimension of a separable filter: even ones as the taps 0..reach, odd ones as the taps on the positive side.
struct Filter {
  std::vector<float> taps;
  bool is_odd = false;
  int reach() const { return static_cast<int>(taps.size()) - 1; }
};

// exp(-pi^2 d^2 / b) at distances d of whole pixels, d^2 in degrees; taps below 1e-9 of the first are left out.
std::vector<double> sensitivity_taps(double b, int reach) {
  std::vector<double> taps;
  for (int i = 0; i <= reach; ++i) {
    const double d = i / kFlipPixelsPerDegree;
    const double tap = exact_exp(-kPi * kPi * d * d / b);
    if (tap < 1e-9) break;
    taps.push_back(tap);
  }
  return taps;
}

double sum_of_even(const std::vector<double>& taps) {
  double sum = taps[0];
  for (size_t i = 1; i < taps.size(); ++i) sum += 2 * taps[i];
  return sum;
}

Filter scaled(const std::vector<double>& taps, double factor, bool is_odd = false) {
  Filter filter;
  for (const double tap : taps) filter.taps.push_back(static_cast<float>(tap * factor));
  filter.is_odd = is_odd;
  return filter;
}

// Contrast sensitivity [FLIP s.4.1.1, Table 1]: one Gaussian for Y and for Cx, the sum of two for Cz; and the feature
// detectors [s.4.2.1]: a Gaussian, whose width is that of an edge, and its first two derivatives.
struct Filters {
  Filter y, cx, cz_wide, cz_narrow;
  Filter gaussian, first, second;
  Filters() {
    constexpr double kBY = 0.0047, kBCx = 0.0053, kACz1 = 34.1, kBCz1 = 0.04, kACz2 = 13.5, kBCz2 = 0.025;
    const int reach = static_cast<int>(std::ceil(3 * std::sqrt(kBCz1 / (2 * kPi * kPi)) * kFlipPixelsPerDegree));
    const auto taps_y = sensitivity_taps(kBY, reach), taps_cx = sensitivity_taps(kBCx, reach);
    y = scaled(taps_y, 1 / sum_of_even(taps_y));
    cx = scaled(taps_cx, 1 / sum_of_even(taps_cx));
    // In two dimensions each Gaussian has its weight a sqrt(pi/b) once: the square root of it in each.
    const auto taps_1 = sensitivity_taps(kBCz1, reach), taps_2 = sensitivity_taps(kBCz2, reach);
    const double weight_1 = std::sqrt(kACz1 * std::sqrt(kPi / kBCz1)), sum_1 = weight_1 * sum_of_even(taps_1);
    const double weight_2 = std::sqrt(kACz2 * std::sqrt(kPi / kBCz2)), sum_2 = weight_2 * sum_of_even(taps_2);
    const double norm = std::sqrt(sum_1 * sum_1 + sum_2 * sum_2);
    cz_wide = scaled(taps_1, weight_1 / norm);
    cz_narrow = scaled(taps_2, weight_2 / norm);
    make_feature_filters();
  }

 private:
  void make_feature_filters() {
    constexpr double kEdgeWidthDegrees = 0.082;
    const double sigma = 0.5 * kEdgeWidthDegrees * kFlipPixelsPerDegree;
    const int reach = static_cast<int>(std::ceil(3 * sigma));
    std::vector<double> g, dg, ddg;
    double odd_sum = 0, positive = 0, negative = 0;  // of one sign of the derivatives
    for (int i = 0; i <= reach; ++i) {
      g.push_back(exact_exp(-i * i / (2 * sigma * sigma)));
      dg.push_back(i * g.back());
      ddg.push_back((i * i / (sigma * sigma) - 1) * g.back());
      odd_sum += dg.back();
      (ddg.back() > 0 ? positive : negative) += std::abs(ddg.back()) * (i == 0 ? 1 : 2);
    }
    for (double& tap : ddg) tap /= tap > 0 ? positive : negative;
    gaussian = scaled(g, 1 / sum_of_even(g));
    first = scaled(dg, 1 / odd_sum, true);
    second = scaled(ddg, 1);
  }
};

// in: filter.reach() readable elements before and after the row's.
void filter_along(const float* in, int width, const Filter& filter, float* out) {
  for (int x = 0; x < width; ++x) out[x] = filter.taps[0] * in[x];
  for (int k = 1; k <= filter.reach(); ++k) {
    const float tap = filter.taps[static_cast<size_t>(k)];
    const float* before = in - k;
    const float* after = in + k;
    if (filter.is_odd) {
      for (int x = 0; x < width; ++x) out[x] += tap * (after[x] - before[x]);
    } else {
      for (int x = 0; x < width; ++x) out[x] += tap * (after[x] + before[x]);
    }
  }
}

// Row y of the plane filtered downwards; the first and last rows count as repeated without end.
void filter_down(const Plane& plane, int y, const Filter& filter, float* out) {
  const int width = plane.width();
  const float* center = plane.row(y);
  for (int x = 0; x < width; ++x) out[x] = filter.taps[0] * center[x];
  for (int k = 1; k <= filter.reach(); ++k) {
    const float tap = filter.taps[static_cast<size_t>(k)];
    const float* above = plane.row(std::max(y - k, 0));
    const float* below = plane.row(std::min(y + k, plane.height() - 1));
    if (filter.is_odd) {
      for (int x = 0; x < width; ++x) out[x] += tap * (below[x] - above[x]);
    } else {
      for (int x = 0; x < width; ++x) out[x] += tap * (below[x] + above[x]);
    }
  }
}

// A picture filtered along its rows by every filter that is to act along or down.
struct FilteredAlong {
  Plane y, cx, cz_wide, cz_narrow, gaussian, first, second;
  FilteredAlong(int width, int height)
      : y(width, height),
        cx(width, height),
        cz_wide(width, height),
        cz_narrow(width, height),
        gaussian(width, height),
        first(width, height),
        second(width, height) {}
};

void filter_row_along(const OpponentPicture& picture, int y, const Filters& filters, FilteredAlong& out) {
  constexpr int kMargin = 16;  // above every reach
  const int width = out.y.width();
  Plane padded(width + 2 * kMargin, 1);
  float* const in = padded.row(0) + kMargin;
  const auto load = [&](const Plane& plane) {
    const float* row = plane.row(y);
    std::copy_n(row, width, in);
    std::fill_n(in - kMargin, kMargin, row[0]);
    std::fill_n(in + width, kMargin, row[width - 1]);
  };
  load(picture.plane[kY]);
  filter_along(in, width, filters.y, out.y.row(y));
  filter_along(in, width, filters.gaussian, out.gaussian.row(y));
  filter_along(in, width, filters.first, out.first.row(y));
  filter_along(in, width, filters.second, out.second.row(y));
  load(picture.plane[kCx]);
  filter_along(in, width, filters.cx, out.cx.row(y));
  load(picture.plane[kCz]);
  filter_along(in, width, filters.cz_wide, out.cz_wide.row(y));
  filter_along(in, width, filters.cz_narrow, out.cz_narrow.row(y));
}

// ---- Differences ---------------------------------------------------------------------------------------------------

// Rows of one picture that the error needs: Lab of what the eye resolves, strength of edges and points.
struct SeenRow {
  Plane rows;
  explicit SeenRow(int width) : rows(width, 11) {}
  float* l() { return rows.row(0); }
  float* a() { return rows.row(1); }
  float* b() { return rows.row(2); }
  float* edge() { return rows.row(3); }
  float* point() { return rows.row(4); }
  float* scratch(int i) { return rows.row(5 + i); }  // i in 0..5
};

void see_colors(const FilteredAlong& picture, int y, const Filters& filters, const RgbFromXyz& rgb_from_xyz,
                SeenRow& out) {
  const int width = picture.y.width();
  float *luma = out.scratch(0), *cx = out.scratch(1), *cz = out.scratch(2), *cz_narrow = out.scratch(3);
  filter_down(picture.y, y, filters.y, luma);
  filter_down(picture.cx, y, filters.cx, cx);
  filter_down(picture.cz_wide, y, filters.cz_wide, cz);
  filter_down(picture.cz_narrow, y, filters.cz_narrow, cz_narrow);
  float *l = out.l(), *a = out.a(), *b = out.b();
  const auto& m = rgb_from_xyz.row;
  for (int x = 0; x < width; ++x) {
    const float xyz_y = luma[x], xyz_x = xyz_y + cx[x], xyz_z = xyz_y - (cz[x] + cz_narrow[x]);
    const Lab lab = hunt_lab_of_linear(clamp_unit(m[0][0] * xyz_x + m[0][1] * xyz_y + m[0][2] * xyz_z),
                                       clamp_unit(m[1][0] * xyz_x + m[1][1] * xyz_y + m[1][2] * xyz_z),
                                       clamp_unit(m[2][0] * xyz_x + m[2][1] * xyz_y + m[2][2] * xyz_z));
    l[x] = lab.l;
    a[x] = lab.a;
    b[x] = lab.b;
  }
}

void see_features(const FilteredAlong& picture, int y, const Filters& filters, SeenRow& out) {
  const int width = picture.y.width();
  float *dx = out.scratch(0), *dy = out.scratch(1), *ddx = out.scratch(2), *ddy = out.scratch(3);
  filter_down(picture.first, y, filters.gaussian, dx);
  filter_down(picture.gaussian, y, filters.first, dy);
  filter_down(picture.second, y, filters.gaussian, ddx);
  filter_down(picture.gaussian, y, filters.second, ddy);
  float *edge = out.edge(), *point = out.point();
  for (int x = 0; x < width; ++x) {
    edge[x] = std::sqrt(dx[x] * dx[x] + dy[x] * dy[x]);
    point[x] = std::sqrt(ddx[x] * ddx[x] + ddy[x] * ddy[x]);
  }
}

// HyAB distances to the power 0.7, up to 0.4 of the largest (green against blue) stretched to 0.95, the rest squeezed
// into what is left [s.4.1.3].
struct ColorError {
  static constexpr float kPower = 0.7f, kBreak = 0.4f, kBreakValue = 0.95f;
  static constexpr float kMaxHyab = 512;  // above every HyAB distance of Hunt-adjusted sRGB: brings it into 0..1
  float largest;
  ColorError() : largest(compressed(hyab(hunt_lab_of_linear(0, 1, 0), hunt_lab_of_linear(0, 0, 1)))) {}
  static float compressed(float distance) { return exact_pow_unit(distance * (1 / kMaxHyab), kPower); }
  float operator()(float distance) const {
    const float error = compressed(distance), bend = kBreak * largest;
    const float low = error * (kBreakValue / bend);
    const float high = kBreakValue + (error - bend) / (largest - bend) * (1 - kBreakValue);
    return error < bend ? low : high;
  }
};

void errors_of_row(SeenRow& reference, SeenRow& test, int width, const ColorError& color_error, float* out) {
  const float *l1 = reference.l(), *a1 = reference.a(), *b1 = reference.b();
  const float *l2 = test.l(), *a2 = test.a(), *b2 = test.b();
  const float *edge1 = reference.edge(), *edge2 = test.edge();
  const float *point1 = reference.point(), *point2 = test.point();
  for (int x = 0; x < width; ++x) {
    const float distance = hyab({l1[x], a1[x], b1[x]}, {l2[x], a2[x], b2[x]});
    const float edge = std::abs(edge1[x] - edge2[x]), point = std::abs(point1[x] - point2[x]);
    const float feature = std::sqrt(0.70710678f * (edge > point ? edge : point));
    const float error = exact_pow_unit(color_error(distance), clamp_unit(1 - feature));
    out[x] = distance > 0 ? error : 0.0f;
  }
}

template <class Fn>
void for_each_row(ThreadPool* pool, int n_rows, Fn&& fn) {
  if (pool != nullptr) {
    pool->for_each(n_rows, fn);
  } else {
    for (int64_t y = 0; y < n_rows; ++y) fn(y);
  }
}

}  // namespace

DepthImage flip_map(ConstRgbView reference, ConstRgbView test, ThreadPool* pool) {
  PAC_ASSERT(!reference.empty() && reference.width == test.width && reference.height == test.height);
  const int width = reference.width, height = reference.height;
  const Filters filters;
  const RgbFromXyz rgb_from_xyz;
  const ColorError color_error;
  const OpponentPicture opponent[2] = {opponent_picture(reference), opponent_picture(test)};
  FilteredAlong along[2] = {FilteredAlong(width, height), FilteredAlong(width, height)};
  for_each_row(pool, height, [&](int64_t y) {
    for (size_t i = 0; i < 2; ++i) filter_row_along(opponent[i], static_cast<int>(y), filters, along[i]);
  });
  DepthImage map(width, height);
  for_each_row(pool, height, [&](int64_t row) {
    const int y = static_cast<int>(row);
    SeenRow seen[2] = {SeenRow(width), SeenRow(width)};
    for (size_t i = 0; i < 2; ++i) {
      see_colors(along[i], y, filters, rgb_from_xyz, seen[i]);
      see_features(along[i], y, filters, seen[i]);
    }
    errors_of_row(seen[0], seen[1], width, color_error, map.row(y));
  });
  return map;
}

double flip_mean(const DepthImage& map) {
  double sum = 0;
  for (int y = 0; y < map.height(); ++y)
    for (int x = 0; x < map.width(); ++x) sum += static_cast<double>(*map.pixel(x, y));
  return sum / (static_cast<double>(map.width()) * map.height());
}

double flip(ConstRgbView reference, ConstRgbView test, ThreadPool* pool) {
  return flip_mean(flip_map(reference, test, pool));
}

RgbImage magma_picture(const DepthImage& map) {
  RgbImage picture(map.width(), map.height());
  for (int y = 0; y < map.height(); ++y)
    for (int x = 0; x < map.width(); ++x) {
      const auto level = static_cast<size_t>(clamp_unit(*map.pixel(x, y)) * 255 + 0.5f);
      std::copy_n(kMagma[level], 3, picture.pixel(x, y));
    }
  return picture;
}

}  // namespace pac
