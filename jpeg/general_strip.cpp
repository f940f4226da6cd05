#include "jpeg/general_strip.h"

#include <algorithm>
#include <cstring>

#include "jpeg/pixel_rows.h"

namespace pac::jpeg {
namespace {

void repeat_last(uint8_t* row, int n, ptrdiff_t padded) {
  if (padded > n) std::memset(row + n, row[n - 1], static_cast<size_t>(padded - n));
}

bool is_usual(const Frame& frame) {
  const Component* c = frame.components;
  if (frame.n_components == 1) return true;
  const bool plain_chroma = c[1].h == 1 && c[1].v == 1 && c[2].h == 1 && c[2].v == 1;
  return plain_chroma && c[0].h <= 2 && c[0].v <= c[0].h;
}

// Output sample i of n / d as many covers the input samples from i d / n on, in nths: where it begins and ends.
struct Cover {
  int begin, end;  // in nths of an input sample
  int first(int n) const { return begin / n; }
  int last(int n) const { return (end - 1) / n; }
  // Nths of input sample `at` that it covers.
  int weight(int at, int n) const { return std::min(end, (at + 1) * n) - std::max(begin, at * n); }
};
Cover cover(int i, int d) {
  return {i * d, (i + 1) * d};
}

}  // namespace

void GeneralStrip::reset(const Frame& frame, const SourceImage& image, const Kernels& kernels) {
  frame_ = frame;
  image_ = image;
  kernels_ = &kernels;
  is_needed_ = (image.rgb.data == nullptr && image.gray.data == nullptr) || !is_usual(frame);
  if (!is_needed_) return;
  const auto width = static_cast<size_t>(frame.mcus_per_row) * 8 * static_cast<size_t>(frame.h_max);
  for (int c = 0; c < frame.n_components && image.planes == nullptr; ++c) {
    full_[c].stride = static_cast<ptrdiff_t>(width);
    full_[c].samples.resize(width * 8 * static_cast<size_t>(frame.v_max));
  }
  spare_.resize(width);
  rgb_.resize(3 * width);
  pulled_row_.resize(image.pulled != nullptr ? 4 * width : 0);
}

void GeneralStrip::load(int mcu_row, int c, uint8_t* samples, ptrdiff_t stride) {
  if (c == 0 && image_.planes == nullptr) load_full(mcu_row);
  const int loaded =
      image_.planes != nullptr ? load_plane(mcu_row, c, samples, stride) : reduce(mcu_row, c, samples, stride);
  for (int y = loaded; y < 8 * frame_.components[c].v; ++y)
    std::memcpy(samples + y * stride, samples + (loaded - 1) * stride, static_cast<size_t>(stride));
}

// Returns how many rows there are.
int GeneralStrip::load_plane(int mcu_row, int c, uint8_t* samples, ptrdiff_t stride) const {
  const Component& component = frame_.components[c];
  const PlaneView<const uint8_t>& plane = c == 0 ? image_.planes->y : c == 1 ? image_.planes->cb : image_.planes->cr;
  const int first = mcu_row * 8 * component.v, n = std::min(8 * component.v, component.height - first);
  for (int y = 0; y < n; ++y) {
    std::memcpy(samples + y * stride, plane.row(first + y), static_cast<size_t>(component.width));
    repeat_last(samples + y * stride, component.width, stride);
  }
  return n;
}

// Rows of the image in groups of v_max, the last group completed by its last row.
void GeneralStrip::load_full(int mcu_row) {
  const int v = frame_.v_max, first = mcu_row * 8 * v, n_rows = std::min(8 * v, frame_.height - first);
  for (int y = 0; y < ceil_div(n_rows, v) * v; ++y) {
    uint8_t* rows[3] = {full_[0].row(y), spare_.data(), spare_.data()};
    for (int c = 1; c < frame_.n_components; ++c) rows[c] = full_[c].row(y);
    if (y < n_rows) {
      load_row(first + y, rows[0], rows[1], rows[2]);
      for (int c = 0; c < frame_.n_components; ++c) repeat_last(rows[c], frame_.width, full_[c].stride);
    } else {
      for (int c = 0; c < frame_.n_components; ++c)
        std::memcpy(rows[c], full_[c].row(y - 1), static_cast<size_t>(full_[c].stride));
    }
  }
}

void GeneralStrip::load_row(int y, uint8_t* luma, uint8_t* cb, uint8_t* cr) {
  const auto n = static_cast<size_t>(frame_.width);
  if (image_.gray.data != nullptr) {
    std::memcpy(luma, image_.gray.row(y), n);
    return;
  }
  if (image_.rgb.data != nullptr) {
    kernels_->pixel.ycc_from_rgb_row(image_.rgb.row(y), n, luma, cb, cr);
    return;
  }
  const uint8_t* row = source_row(y);
  const PixelFormat format = image_.pixels.format;
  if (format == PixelFormat::gray) {
    std::memcpy(luma, row, n);
  } else if (format == PixelFormat::rgb) {
    kernels_->pixel.ycc_from_rgb_row(row, n, luma, cb, cr);
  } else {
    rgb_from_pixels(format, row, n, rgb_.data());
    kernels_->pixel.ycc_from_rgb_row(rgb_.data(), n, luma, cb, cr);
  }
}

const uint8_t* GeneralStrip::source_row(int y) {
  if (image_.pulled == nullptr) return image_.pixels.row(y);
  const size_t size = static_cast<size_t>(frame_.width) * static_cast<size_t>(bytes_per_pixel(image_.pixels.format));
  PulledRows& pulled = *image_.pulled;
  if (!pulled.failed && !(*pulled.source)(y, {pulled_row_.data(), size})) {
    pulled.failed = true;
    std::fill(pulled_row_.begin(), pulled_row_.end(), uint8_t{0});
  }
  return pulled_row_.data();
}

// Averages boxes; the usual ratios as the IJG software rounds them. Returns how many rows there are.
int GeneralStrip::reduce(int mcu_row, int c, uint8_t* samples, ptrdiff_t stride) {
  const Component& component = frame_.components[c];
  const int n_rows = std::min(8 * frame_.v_max, frame_.height - mcu_row * 8 * frame_.v_max);
  const int groups = ceil_div(n_rows, frame_.v_max), n_out = groups * component.v;
  const auto n = static_cast<size_t>(component.padded_width_blocks) * 8;
  const bool half_width = component.h * 2 == frame_.h_max, same_height = component.v == frame_.v_max;
  FullRows& full = full_[c];
  for (int y = 0; y < n_out; ++y) {
    uint8_t* out = samples + y * stride;
    if (component.h == frame_.h_max && same_height)
      std::memcpy(out, full.row(y), n);
    else if (half_width && same_height)
      kernels_->pixel.downsample_h2v1_row(full.row(y), n, out);
    else if (half_width && component.v * 2 == frame_.v_max)
      kernels_->pixel.downsample_h2v2_row(full.row(2 * y), full.row(2 * y + 1), n, out);
    else
      average_row(c, y, out);
    repeat_last(out, static_cast<int>(n), stride);
  }
  return n_out;
}

// The mean of the input samples that an output sample covers, each by the part covered, rounded to nearest, halves up.
void GeneralStrip::average_row(int c, int y, uint8_t* out) {
  const Component& component = frame_.components[c];
  const int h = component.h, v = component.v, area = frame_.h_max * frame_.v_max;
  const Cover rows = cover(y, frame_.v_max);
  for (int x = 0; x < 8 * component.padded_width_blocks; ++x) {
    const Cover columns = cover(x, frame_.h_max);
    int sum = 0;
    for (int j = rows.first(v); j <= rows.last(v); ++j) {
      const uint8_t* row = full_[c].row(j);
      int row_sum = 0;
      for (int i = columns.first(h); i <= columns.last(h); ++i) row_sum += columns.weight(i, h) * row[i];
      sum += rows.weight(j, v) * row_sum;
    }
    out[x] = static_cast<uint8_t>((2 * sum + area) / (2 * area));
  }
}

}  // namespace pac::jpeg
