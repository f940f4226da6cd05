#include "sim/frame420.h"

#include <algorithm>
#include <cstring>
#include <vector>

#include "base/kernels/kernels.h"

namespace pac::sim {

namespace {

const PixelKernels& pixel_kernels(Isa isa) {
  const Kernels* table = kernels_for(isa);
  PAC_ASSERT(table != nullptr);
  return table->pixel;
}

// A row of one component with room for one repeated sample.
struct RowPair {
  explicit RowPair(size_t n) : upper(n + 1), lower(n + 1) {}
  std::vector<uint8_t> upper, lower;
};

}  // namespace

void frame420_from_rgb(ConstRgbView picture, Frame420& frame, Isa isa) {
  frame420_rows_from_rgb(picture, 0, picture.height, frame, isa);
}

void frame420_rows_from_rgb(ConstRgbView picture, int first, int last, Frame420& frame, Isa isa) {
  PAC_ASSERT(frame.width() == picture.width && frame.height() == picture.height);
  PAC_ASSERT(first % 2 == 0 && (last % 2 == 0 || last == picture.height));
  if (picture.empty()) return;
  const PixelKernels& kernels = pixel_kernels(isa);
  const auto n = static_cast<size_t>(picture.width);
  RowPair cb(n), cr(n);
  const auto convert = [&](int y, std::vector<uint8_t>& cb_row, std::vector<uint8_t>& cr_row) {
    kernels.ycc_from_rgb_row(picture.row(y), n, frame.y.row(y), cb_row.data(), cr_row.data());
    cb_row[n] = cb_row[n - 1];
    cr_row[n] = cr_row[n - 1];
  };
  for (int y = first / 2; y < (last + 1) / 2; ++y) {
    convert(2 * y, cb.upper, cr.upper);
    if (2 * y + 1 < picture.height) {
      convert(2 * y + 1, cb.lower, cr.lower);
    } else {
      cb.lower = cb.upper;
      cr.lower = cr.upper;
    }
    const auto half = static_cast<size_t>(frame.cb.width());
    kernels.downsample_h2v2_row(cb.upper.data(), cb.lower.data(), half, frame.cb.row(y));
    kernels.downsample_h2v2_row(cr.upper.data(), cr.lower.data(), half, frame.cr.row(y));
  }
}

void upsample_chroma(PlaneView<const uint8_t> half, PlaneView<uint8_t> full, Isa isa) {
  PAC_ASSERT(half.width == (full.width + 1) / 2 && half.height == (full.height + 1) / 2);
  const PixelKernels& kernels = pixel_kernels(isa);
  std::vector<uint8_t> row(static_cast<size_t>(half.width) * 2);
  for (int y = 0; y < full.height; ++y) {
    const int near = y / 2, far = std::clamp((y & 1) != 0 ? near + 1 : near - 1, 0, half.height - 1);
    kernels.upsample_h2v2_row(half.row(near), half.row(far), static_cast<size_t>(half.width), row.data());
    std::memcpy(full.row(y), row.data(), static_cast<size_t>(full.width));
  }
}

void rgb_from_frame420(const Frame420& frame, RgbView picture, Isa isa) {
  PAC_ASSERT(frame.width() == picture.width && frame.height() == picture.height);
  if (picture.empty()) return;
  GrayImage cb(picture.width, picture.height), cr(picture.width, picture.height);
  upsample_chroma(frame.cb.view(), cb.view(), isa);
  upsample_chroma(frame.cr.view(), cr.view(), isa);
  const PixelKernels& kernels = pixel_kernels(isa);
  for (int y = 0; y < picture.height; ++y)
    kernels.rgb_from_ycc_row(frame.y.row(y), cb.row(y), cr.row(y), static_cast<size_t>(picture.width), picture.row(y));
}

}  // namespace pac::sim
