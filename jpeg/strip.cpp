#include "jpeg/strip.h"

#include <algorithm>
#include <cstring>

namespace pac::jpeg {
namespace {

void repeat_last(uint8_t* row, int n, ptrdiff_t padded) {
  std::memset(row + n, row[n - 1], static_cast<size_t>(padded - n));
}

}  // namespace

SamplingFactors factors_of(Subsampling subsampling) {
  SamplingFactors factors;
  if (subsampling == Subsampling::yuv422 || subsampling == Subsampling::yuv420) factors.h[0] = 2;
  if (subsampling == Subsampling::yuv420) factors.v[0] = 2;
  return factors;
}

Frame make_frame(int width, int height, int n_components, const SamplingFactors& sampling) {
  Frame frame;
  frame.width = width;
  frame.height = height;
  frame.n_components = n_components;
  for (uint8_t i = 0; i < n_components; ++i) {
    Component& c = frame.components[i];
    c.id = static_cast<uint8_t>(i + 1);
    c.quant_table = i == 0 ? 0 : 1;
    c.h = n_components > 1 ? sampling.h[i] : uint8_t{1};
    c.v = n_components > 1 ? sampling.v[i] : uint8_t{1};
  }
  finish_frame(frame);
  return frame;
}

Frame make_frame(int width, int height, Subsampling subsampling) {
  return make_frame(width, height, subsampling == Subsampling::gray ? 1 : 3, factors_of(subsampling));
}

Frame make_frame(const SourceImage& image, const EncodeOptions& options) {
  return make_frame(image.width(), image.height(), options.subsampling == Subsampling::gray ? 1 : 3,
                    options.sampling ? *options.sampling : factors_of(options.subsampling));
}

int StripTransform::rows_of_blocks(const Component& c, int mcu_row) {
  return std::min<int>(c.v, c.height_blocks - mcu_row * c.v);
}

void StripTransform::reset(const Frame& frame, const SourceImage& image, const Kernels& kernels) {
  frame_ = frame;
  image_ = image;
  kernels_ = &kernels;
  general_.reset(frame, image, kernels);
  // Two samples for each chroma sample, so that the last box of a row is complete.
  const ptrdiff_t full_width = ptrdiff_t{frame.mcus_per_row} * 8 * frame.h_max;
  for (int i = 0; i < frame.n_components; ++i) {
    planes_[i].stride = full_width;
    planes_[i].samples.resize(static_cast<size_t>(full_width * 8 * frame.components[i].v));
  }
  for (Plane& plane : full_chroma_) {
    plane.stride = full_width;
    plane.samples.resize(static_cast<size_t>(full_width));
  }
  spare_.resize(static_cast<size_t>(full_width));
}

void StripTransform::load_row(int y, uint8_t* luma, uint8_t* cb, uint8_t* cr) const {
  const auto n = static_cast<size_t>(frame_.width);
  if (image_.gray.data != nullptr)
    std::memcpy(luma, image_.gray.row(y), n);
  else
    kernels_->pixel.ycc_from_rgb_row(image_.rgb.row(y), n, luma, cb, cr);
}

// Two rows at a time through one kernel. The last pixels of a row, repeated to a whole MCU, go through it by
// themselves.
void StripTransform::load_420(int mcu_row) {
  const int first = 16 * mcu_row, n_rows = std::min(16, frame_.height - first);
  const ptrdiff_t full_width = planes_[0].stride;
  const ptrdiff_t main = frame_.width & ~3;  // the rounding of chroma alternates with its position
  const auto n_rest = static_cast<size_t>(full_width - main);
  for (int y = 0; y < n_rows; y += 2) {
    const uint8_t* const rgb[2] = {image_.rgb.row(first + y),
                                   image_.rgb.row(std::min(first + y + 1, frame_.height - 1))};
    uint8_t *const upper = planes_[0].row(y), *const lower = planes_[0].row(y + 1);
    uint8_t *const cb = planes_[1].row(y / 2), *const cr = planes_[2].row(y / 2);
    kernels_->pixel.ycc420_from_rgb_rows(rgb[0], rgb[1], static_cast<size_t>(main), upper, lower, cb, cr);
    uint8_t rest[2][3 * 20];  // at most 3 pixels and 15 more
    for (int i = 0; i < 2 && n_rest > 0; ++i)
      for (ptrdiff_t x = main; x < full_width; ++x)
        std::memcpy(rest[i] + 3 * (x - main), rgb[i] + 3 * std::min<ptrdiff_t>(x, frame_.width - 1), 3);
    kernels_->pixel.ycc420_from_rgb_rows(rest[0], rest[1], n_rest, upper + main, lower + main, cb + main / 2,
                                         cr + main / 2);
  }
  repeat_last_rows(n_rows);
}

// Fills planes_ with the samples of one MCU row.
void StripTransform::load(int mcu_row) {
  if (general_.is_needed()) {
    for (int c = 0; c < frame_.n_components; ++c)
      general_.load(mcu_row, c, planes_[c].samples.data(), planes_[c].stride);
    return;
  }
  const int h = frame_.h_max, mcu_height = 8 * frame_.v_max;
  const bool color = frame_.n_components == 3;
  if (color && frame_.v_max == 2 && image_.rgb.data != nullptr) {
    load_420(mcu_row);
    return;
  }
  const int first = mcu_row * mcu_height, n_rows = std::min(mcu_height, frame_.height - first);
  const ptrdiff_t full_width = planes_[0].stride;
  for (int y = 0; y < n_rows; ++y) {
    uint8_t* rows[3] = {planes_[0].row(y), spare_.data(), spare_.data()};
    for (int c = 1; color && c < 3; ++c) rows[c] = h == 1 ? planes_[c].row(y) : full_chroma_[c - 1].row(0);
    load_row(first + y, rows[0], rows[1], rows[2]);
    for (int c = 0; c < frame_.n_components; ++c) repeat_last(rows[c], frame_.width, full_width);
    for (int c = 1; color && h == 2 && c < 3; ++c)
      kernels_->pixel.downsample_h2v1_row(rows[c], static_cast<size_t>(8 * frame_.mcus_per_row), planes_[c].row(y));
  }
  repeat_last_rows(n_rows);
}

// Below the image's last rows, of which the planes hold n_rows: the last downsampled one.
void StripTransform::repeat_last_rows(int n_rows) {
  for (int c = 0; c < frame_.n_components; ++c) {
    const int v = frame_.v_max, loaded = ceil_div(n_rows, v) * frame_.components[c].v;
    for (int y = loaded; y < 8 * frame_.components[c].v; ++y)
      std::memcpy(planes_[c].row(y), planes_[c].row(loaded - 1), static_cast<size_t>(planes_[c].stride));
  }
}

void StripTransform::transform(int mcu_row, int16_t* const (&out)[3]) {
  load(mcu_row);
  for (int c = 0; c < frame_.n_components; ++c) {
    const Component& component = frame_.components[c];
    const auto n_blocks = static_cast<size_t>(component.width_blocks);
    for (int by = 0; by < rows_of_blocks(component, mcu_row); ++by)
      kernels_->block.fdct_islow(planes_[c].row(8 * by), planes_[c].stride, n_blocks,
                                 out[c] + static_cast<size_t>(by) * n_blocks * 64);
  }
}

void StripTransform::quantize(int mcu_row, const BlockQuantizer (&quantizers)[2], int16_t* const (&levels)[3],
                              uint64_t* const (&nonzero)[3]) {
  load(mcu_row);
  for (int c = 0; c < frame_.n_components; ++c) {
    const Component& component = frame_.components[c];
    const auto n_blocks = static_cast<size_t>(component.width_blocks);
    for (int by = 0; by < rows_of_blocks(component, mcu_row); ++by) {
      const size_t first = static_cast<size_t>(by) * n_blocks;
      kernels_->block.fdct_quantize(planes_[c].row(8 * by), planes_[c].stride, n_blocks, quantizers[c == 0 ? 0 : 1],
                                    levels[c] + 64 * first, nonzero[c] + first);
    }
  }
}

}  // namespace pac::jpeg
