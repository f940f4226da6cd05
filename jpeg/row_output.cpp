#include "jpeg/row_output.h"

#include <algorithm>
#include <cstring>

#include "jpeg/pixel_rows.h"

namespace pac::jpeg {

void RowOutput::start(const RowTarget& target, const Crop& window, int first_column, int width, ColorModel color) {
  target_ = target;
  window_ = window;
  color_ = color;
  skipped_ = window.x - first_column;
  row_width_ = width;
  is_stopped_ = false;
  rgb_.resize(3 * static_cast<size_t>(width));
  converted_.resize(target.sink != nullptr ? 4 * static_cast<size_t>(window.width) : 0);
}

void RowOutput::rows_ready(int begin, int end, ComponentPlanes& planes) {
  begin = std::max(begin, window_.y);
  end = std::min(end, window_.y + window_.height);
  if (begin >= end) return;
  if (target_.rgb.data != nullptr && window_.y == 0 && row_width_ == window_.width) {
    planes.write_rgb(begin, end, target_.rgb);
    return;
  }
  for (int y = begin; y < end && !is_stopped_; ++y) write_row(y, planes);
}

const uint8_t* RowOutput::rgb_row(int y, ComponentPlanes& planes) {
  planes.write_rgb(y, y + 1, RgbView{rgb_.data(), row_width_, y + 1, 0});
  return rgb_.data() + 3 * skipped_;
}

void RowOutput::write_row(int y, ComponentPlanes& planes) {
  const auto n = static_cast<size_t>(window_.width);
  const int row = y - window_.y;
  if (target_.rgb.data != nullptr) {
    std::memcpy(target_.rgb.row(row), rgb_row(y, planes), 3 * n);
    return;
  }
  const PixelFormat format = target_.sink != nullptr ? target_.format : target_.pixels.format;
  uint8_t* out = target_.sink != nullptr ? converted_.data() : target_.pixels.row(row);
  const bool has_luma = color_ == ColorModel::ycc || color_ == ColorModel::gray;
  if (format == PixelFormat::gray && has_luma)
    std::memcpy(out, planes.first_row(y) + skipped_, n);
  else
    pixels_from_rgb(format, rgb_row(y, planes), n, out);
  if (target_.sink != nullptr)
    is_stopped_ = !(*target_.sink)(row, {out, n * static_cast<size_t>(bytes_per_pixel(format))});
}

}  // namespace pac::jpeg
