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
    plane.samples.resize(static_cast<size_t>(2 * full_width));
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

// Fills planes_ with the samples of one MCU row.
void StripTransform::load(int mcu_row) {
  if (general_.is_needed()) {
    for (int c = 0; c < frame_.n_components; ++c)
      general_.load(mcu_row, c, planes_[c].samples.data(), planes_[c].stride);
    return;
  }
  const int h = frame_.h_max, v = frame_.v_max, mcu_height = 8 * v;
  const int first = mcu_row * mcu_height, n_rows = std::min(mcu_height, frame_.height - first);
  const ptrdiff_t full_width = planes_[0].stride;
  const bool color = frame_.n_components == 3, direct = h == 1 && v == 1;
  for (int group = 0; group < ceil_div(n_rows, v); ++group) {
    for (int i = 0; i < v; ++i) {
      const int y = group * v + i;
      uint8_t* rows[3] = {planes_[0].row(y), spare_.data(), spare_.data()};
      for (int c = 1; color && c < 3; ++c) rows[c] = direct ? planes_[c].row(y) : full_chroma_[c - 1].row(i);
      load_row(std::min(first + y, frame_.height - 1), rows[0], rows[1], rows[2]);
      for (int c = 0; c < frame_.n_components; ++c) repeat_last(rows[c], frame_.width, full_width);
    }
    for (int c = 1; color && !direct && c < 3; ++c) {
      Plane& full = full_chroma_[c - 1];
      const auto n = static_cast<size_t>(8 * frame_.mcus_per_row);
      if (v == 2)
        kernels_->pixel.downsample_h2v2_row(full.row(0), full.row(1), n, planes_[c].row(group));
      else
        kernels_->pixel.downsample_h2v1_row(full.row(0), n, planes_[c].row(group));
    }
  }
  for (int c = 0; c < frame_.n_components; ++c) {
    const int loaded = ceil_div(n_rows, v) * frame_.components[c].v;
    for (int y = loaded; y < 8 * frame_.components[c].v; ++y)
      std::memcpy(planes_[c].row(y), planes_[c].row(loaded - 1), static_cast<size_t>(full_width));
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
