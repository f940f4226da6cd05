#include "jpeg/coefficients.h"

namespace pac::jpeg {
namespace {

size_t strip_size(const Component& c) {
  return size_t{64} * static_cast<size_t>(c.width_blocks) * c.v;
}

}  // namespace

void CoefficientSource::reset(const SourceImage& image, const Frame& frame, const Kernels& kernels, bool keep_all,
                              int first_row, int end_row) {
  frame_ = frame;
  keep_all_ = keep_all;
  kernels_ = &kernels;
  strips_.reset(frame_, image, kernels);
  first_row_ = first_row;
  const int n_strips = keep_all ? end_row - first_row : 1;
  for (int c = 0; c < frame_.n_components; ++c)
    coefficients_[c].resize(strip_size(frame_.components[c]) * static_cast<size_t>(n_strips));
  for (int mcu_row = first_row; keep_all && mcu_row < end_row; ++mcu_row) {
    int16_t* out[3] = {};
    for (int c = 0; c < frame_.n_components; ++c) out[c] = strip(c, mcu_row);
    strips_.transform(mcu_row, out);
  }
}

int16_t* CoefficientSource::strip(int c, int mcu_row) {
  const auto index = static_cast<size_t>(keep_all_ ? mcu_row - first_row_ : 0);
  return coefficients_[c].data() + strip_size(frame_.components[c]) * index;
}

void CoefficientSource::load(int mcu_row) {
  int16_t* out[3] = {};
  for (int c = 0; c < frame_.n_components; ++c) row_[c] = out[c] = strip(c, mcu_row);
  if (!keep_all_) strips_.transform(mcu_row, out);
}

void CoefficientSource::quantize(int mcu_row, const BlockQuantizer (&quantizers)[2], Levels& levels) {
  int16_t* zigzag[3] = {};
  uint64_t* nonzero[3] = {};
  for (int c = 0; c < frame_.n_components; ++c) {
    zigzag[c] = levels.zigzag[c].data();
    nonzero[c] = levels.nonzero[c].data();
  }
  if (!keep_all_) {
    strips_.quantize(mcu_row, quantizers, zigzag, nonzero);
    return;
  }
  load(mcu_row);
  for (int c = 0; c < frame_.n_components; ++c)
    kernels_->block.quantize(row_[c], quantizers[c == 0 ? 0 : 1], n_blocks(c, mcu_row), zigzag[c], nonzero[c]);
}

}  // namespace pac::jpeg
