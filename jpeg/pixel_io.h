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

// ---- Encoding -----------------------------------------------------------------------------------------------------

// As encode(), of any pixel format; gray is one component, whatever options.subsampling says. Errors: as encode.
Result<std::vector<uint8_t>> encode_pixels(ConstPixelView image, const EncodeOptions& options = {});

// Pulls rows from `source` as they are needed. With standard Huffman tables (or options.stream) and neither trellis nor
// fitted or adapted tables, working memory is a few rows of MCUs whatever the height; optimal Huffman tables keep 4
// bytes for each coefficient that is not zero, the others all coefficients. One thread. Errors: as encode; bad_argument
// where the source has no row to give.
Result<std::vector<uint8_t>> encode_rows(int width, int height, PixelFormat format, const RowSource& source,
                                         const EncodeOptions& options = {});

// The same, whose bytes leave as they are made, in pieces of some kilobytes. A receiver that returns false ends it:
// out_of_space. Tells how many bytes left.
using ByteReceiver = std::function<bool(std::span<const uint8_t> bytes)>;
Result<uint64_t> encode_rows(int width, int height, PixelFormat format, const RowSource& source,
                             const ByteReceiver& receiver, const EncodeOptions& options = {});

// Samples of Y, Cb and Cr [JFIF 1.02 p.3], or of Y alone with Subsampling::gray: what the file will hold, neither
// converted nor averaged. Sizes as the sampling factors say: that of the picture times h / h_max and v / v_max, rounded
// up.
struct YccPlanes {
  int width = 0, height = 0;  // pixels
  PlaneView<const uint8_t> y, cb, cr;
};
// Errors: as encode; bad_argument (a plane has another size).
Result<std::vector<uint8_t>> encode_planes(const YccPlanes& planes, const EncodeOptions& options = {});

// ---- Decoding -----------------------------------------------------------------------------------------------------

enum class Damaged : uint8_t {
  fail,  // strict: a whole, sound picture or a Failure
  keep,  // lenient: what the file still holds, as decode_lenient() has it
};

// How it went. `failure` and `errors` only with Damaged::keep.
struct DecodeReport {
  int width = 0, height = 0;       // pixels delivered: of the crop, or the scaled picture
  std::optional<Failure> failure;  // the first thing wrong
  int errors = 0;                  // things wrong
  int warnings = 0;                // oddities that harm nothing
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
