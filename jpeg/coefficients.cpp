#include "jpeg/coefficients.h"

namespace pac::jpeg {
namespace {

size_t strip_size(const Component& c) {
  return size_t{64} * static_cast<size_t>(c.width_blocks) * c.v;
}

}  // namespace

void CoefficientSource::reset(const SourceImage& image, Subsampling subsampling, const Kernels& kernels,
                              bool keep_all) {
  frame_ = make_frame(image.width(), image.height(), subsampling);
  keep_all_ = keep_all;
  strips_.reset(frame_, image, kernels);
  const int n_strips = keep_all ? frame_.mcu_rows : 1;
  for (int c = 0; c < frame_.n_components; ++c)
    coefficients_[c].resize(strip_size(frame_.components[c]) * static_cast<size_t>(n_strips));
  for (int mcu_row = 0; keep_all && mcu_row < frame_.mcu_rows; ++mcu_row) {
    int16_t* out[3] = {};
    for (int c = 0; c < frame_.n_components; ++c)
      out[c] = coefficients_[c].data() + strip_size(frame_.components[c]) * static_cast<size_t>(mcu_row);
    strips_.transform(mcu_row, out);
  }
}

void CoefficientSource::load(int mcu_row) {
  int16_t* out[3] = {};
  for (int c = 0; c < frame_.n_components; ++c) {
    out[c] = coefficients_[c].data();
    if (keep_all_) out[c] += strip_size(frame_.components[c]) * static_cast<size_t>(mcu_row);
    row_[c] = out[c];
  }
  if (!keep_all_) strips_.transform(mcu_row, out);
}

}  // namespace pac::jpeg
