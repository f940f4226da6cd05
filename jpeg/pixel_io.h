// Pictures as pixels of any format, as rows that come and go one at a time, and as planes of samples.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "jpeg/jpeg.h"
#include "jpeg/pixels.h"

namespace pac::jpeg {

// ---- Decoding -----------------------------------------------------------------------------------------------------

enum class Damaged : uint8_t {
  fail,  // strict: a whole, sound picture or a Failure
  keep,  // lenient: what the file still holds, as decode_lenient() has it
};

// How it went. `failure` and errors among the `warnings` only with Damaged::keep.
struct DecodeReport {
  int width = 0, height = 0;       // pixels delivered: of the crop, or the scaled picture
  std::optional<Failure> failure;  // the first thing wrong
  int warnings = 0;                // things wrong, and oddities that harm nothing
};

// Into the caller's pixels; `out` has the crop's size or that of scaled_size(). Errors: as decode; bad_argument
// (another size). On failure the contents of `out` are unspecified.
Result<DecodeReport> decode_pixels(std::span<const uint8_t> bytes, PixelView out, const DecodeOptions& options = {},
                                   Damaged damaged = Damaged::fail);

// Hands rows to `sink` as soon as their samples are there. Of a sequential file with one scan, working memory is two
// rows of MCUs and some 50 KB, whatever the height; files with several scans and progressive ones need all their
// samples or levels. On failure some rows may have been delivered. A sink that wants no more ends decoding without a
// Failure, and what follows is not checked. One thread. Errors: as decode.
Result<DecodeReport> decode_rows(std::span<const uint8_t> bytes, PixelFormat format, const RowSink& sink,
                                 const DecodeOptions& options = {}, Damaged damaged = Damaged::fail);

// Samples of one component, rows without gaps.
struct SamplePlane {
  int width = 0, height = 0;  // samples: the picture's size times h / h_max, v / v_max, rounded up
  int h = 1, v = 1;           // sampling factors
  std::vector<uint8_t> samples;
  const uint8_t* row(int y) const { return samples.data() + static_cast<size_t>(y) * static_cast<size_t>(width); }
};

struct SamplePlanes {
  int width = 0, height = 0;  // pixels
  ColorModel color = ColorModel::unknown;
  std::vector<SamplePlane> planes;  // 1, 3 or 4 components in the file's order
};

// The components as the file holds them, neither upsampled nor converted: YCbCr of most files, CMYK as stored. Scaled
// pictures: see h and v, some components may keep more samples. options.crop is bad_argument. Errors: as decode.
Result<SamplePlanes> decode_planes(std::span<const uint8_t> bytes, const DecodeOptions& options = {},
                                   Damaged damaged = Damaged::fail);

}  // namespace pac::jpeg
