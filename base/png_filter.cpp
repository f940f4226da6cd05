#include "base/png_filter.h"

#include <algorithm>
#include <cstring>

namespace pac {

void filter_png_row(PngFilter filter, const uint8_t* row, const uint8_t* above, size_t n, size_t bytes_per_pixel,
                    uint8_t* out) {
  const size_t bpp = bytes_per_pixel, first = std::min(n, bpp);  // the first bytes have no left neighbor: a = c = 0
  switch (filter) {
    case PngFilter::none:
      std::memcpy(out, row, n);
      return;
    case PngFilter::sub:
      std::memcpy(out, row, first);
      for (size_t i = first; i < n; ++i) out[i] = static_cast<uint8_t>(row[i] - row[i - bpp]);
      return;
    case PngFilter::up:
      for (size_t i = 0; i < n; ++i) out[i] = static_cast<uint8_t>(row[i] - above[i]);
      return;
    case PngFilter::average:
      for (size_t i = 0; i < first; ++i) out[i] = static_cast<uint8_t>(row[i] - above[i] / 2);
      for (size_t i = first; i < n; ++i) out[i] = static_cast<uint8_t>(row[i] - (row[i - bpp] + above[i]) / 2);
      return;
    case PngFilter::paeth:
      for (size_t i = 0; i < first; ++i) out[i] = static_cast<uint8_t>(row[i] - above[i]);
      for (size_t i = first; i < n; ++i)
        out[i] = static_cast<uint8_t>(row[i] - paeth_predictor(row[i - bpp], above[i], above[i - bpp]));
      return;
  }
}

void unfilter_png_row(PngFilter filter, uint8_t* row, const uint8_t* above, size_t n, size_t bytes_per_pixel) {
  const size_t bpp = bytes_per_pixel, first = std::min(n, bpp);
  switch (filter) {
    case PngFilter::none:
      return;
    case PngFilter::sub:
      for (size_t i = first; i < n; ++i) row[i] = static_cast<uint8_t>(row[i] + row[i - bpp]);
      return;
    case PngFilter::up:
      for (size_t i = 0; i < n; ++i) row[i] = static_cast<uint8_t>(row[i] + above[i]);
      return;
    case PngFilter::average:
      for (size_t i = 0; i < first; ++i) row[i] = static_cast<uint8_t>(row[i] + above[i] / 2);
      for (size_t i = first; i < n; ++i) row[i] = static_cast<uint8_t>(row[i] + (row[i - bpp] + above[i]) / 2);
      return;
    case PngFilter::paeth:
      for (size_t i = 0; i < first; ++i) row[i] = static_cast<uint8_t>(row[i] + above[i]);
      for (size_t i = first; i < n; ++i)
        row[i] = static_cast<uint8_t>(row[i] + paeth_predictor(row[i - bpp], above[i], above[i - bpp]));
      return;
  }
}

}  // namespace pac
