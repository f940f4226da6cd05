// How much errors of each block count for the trellis: where they hide, and what the caller says.
#include <algorithm>

#include "jpeg/image_encoder.h"

namespace pac::jpeg {

// Of each luma block of the picture seen, in rows.
void ImageEncoder::measure_seen() {
  CoefficientSource seen;
  const int n_rows = ceil_div(options_.seen.height, 8);
  SourceImage image;
  image.rgb = options_.seen;
  seen.reset(image, make_frame(options_.seen.width, options_.seen.height, Subsampling::gray), *kernels_, false, 0,
             n_rows);
  for (int row = 0; row < n_rows; ++row) {
    seen.load(row);
    const size_t n = seen.n_blocks(0, row);
    for (size_t i = 0; i < n; ++i) seen_visibility_.push_back(visibility(masking_, seen.row(0) + 64 * i));
  }
}

// Of luma block i of a loaded MCU row.
float ImageEncoder::visibility_of(const Band& band, int mcu_row, size_t i) const {
  if (seen_visibility_.empty()) return visibility(masking_, band.source.row(0) + 64 * i);
  const Component& luma = band.source.frame().components[0];
  return seen_visibility_[static_cast<size_t>(mcu_row) * luma.v * static_cast<size_t>(luma.width_blocks) + i];
}

// From blocks of pixels to those of the components: the mean of all that a block touches.
void ImageEncoder::spread_importance(const Frame& frame) {
  const int columns = ceil_div(frame.width, 8), rows = ceil_div(frame.height, 8);
  for (int c = 0; c < frame.n_components; ++c) {
    const Component& component = frame.components[c];
    for (int by = 0; by < component.height_blocks; ++by)
      for (int bx = 0; bx < component.width_blocks; ++bx) {
        const int left = bx * frame.h_max / component.h, top = by * frame.v_max / component.v;
        const int right = std::min(ceil_div((bx + 1) * frame.h_max, component.h), columns);
        const int bottom = std::min(ceil_div((by + 1) * frame.v_max, component.v), rows);
        float sum = 0;
        for (int y = top; y < bottom; ++y)
          for (int x = left; x < right; ++x)
            sum += options_.importance[static_cast<size_t>(y) * static_cast<size_t>(columns) + static_cast<size_t>(x)];
        importance_[c].push_back(sum / static_cast<float>((right - left) * (bottom - top)));
      }
  }
}

// Of block i of component c in a loaded MCU row: what the caller says, and in luma how much errors hide.
float ImageEncoder::importance_of(const Band& band, int c, int mcu_row, size_t i) const {
  const float shows = c == 0 ? visibility_of(band, mcu_row, i) / mean_visibility_ : 1.0f;
  if (importance_[c].empty()) return shows;
  const Component& component = band.source.frame().components[c];
  const size_t before = static_cast<size_t>(mcu_row) * component.v * static_cast<size_t>(component.width_blocks);
  return shows * importance_[c][before + i];
}

}  // namespace pac::jpeg
