// Row filters of PNG [PNG 9]: each byte is predicted from the bytes to the left (a), above (b) and above left (c).
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>

namespace pac {

enum class PngFilter : uint8_t { none, sub, up, average, paeth };
constexpr int kPngFilterCount = 5;

// Of a, b, c the nearest to a + b - c; ties in this order [PNG 9.4].
inline uint8_t paeth_predictor(int a, int b, int c) {
  const int pa = std::abs(b - c), pb = std::abs(a - c), pc = std::abs(a + b - 2 * c);
  return static_cast<uint8_t>(pa <= pb && pa <= pc ? a : pb <= pc ? b : c);
}

// out[i] = row[i] - prediction. `row` and `above` have n bytes; bytes left of the row's first pixel count as zero. The
// pixel distance is bytes_per_pixel (1..8).
void filter_png_row(PngFilter filter, const uint8_t* row, const uint8_t* above, size_t n, size_t bytes_per_pixel,
                    uint8_t* out);

// The inverse, in place. `above` is the previous row, already restored, or zeros.
void unfilter_png_row(PngFilter filter, uint8_t* row, const uint8_t* above, size_t n, size_t bytes_per_pixel);

}  // namespace pac
