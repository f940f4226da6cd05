// Second half of the decoder: component samples -> upsampled rows -> RGB rows.
#pragma once

#include <cstdint>
#include <vector>

#include "base/image.h"
#include "base/kernels/kernels.h"
#include "jpeg/frame.h"
#include "jpeg/jpeg.h"
#include "jpeg/picture_window.h"

namespace pac::jpeg {

// Samples of all components, whole MCUs. Holds either the whole image or, when a file has one scan of all components, a
// ring of two MCU rows: upsampling a row needs one neighbor above and below, never more.
class ComponentPlanes {
 public:
  // Bytes that reset() will take, to be checked against Limits before.
  static uint64_t size_bytes(const Frame& frame, bool whole_image);
  static uint64_t size_bytes(const ScaledFrame& scaled, bool whole_image);
  // Keeps its buffers from image to image when they suffice.
  void reset(const ScaledFrame& scaled, bool whole_image, ColorModel color, const Kernels& kernels);
  // Two MCU rows, or one of a picture that has no more; their samples are not set.
  void reset_ring(const Frame& frame, ColorModel color, const Kernels& kernels);

  // Only the MCU columns [first, end) count: write_rgb() and gray_row() act as if the picture consisted of those (their
  // outermost pixels next to other columns differ). After reset().
  void narrow(int first, int end);

  // Samples a side of component c's blocks: 8, or less in a scaled picture.
  int block_size(int c) const { return planes_[c].block_size; }
  // Where the block_size(c) rows of block row `by` of component c start, and how far apart rows are.
  uint8_t* block_row(int c, int by) {
    Plane& plane = planes_[c];
    return plane.samples.data() + plane.block_size * by % plane.n_rows * plane.stride;
  }
  ptrdiff_t stride(int c) const { return planes_[c].stride; }

  // Writes RGB rows [y_begin, y_end) of the image to out (row y at out.row(y)).
  void write_rgb(int y_begin, int y_end, RgbView out);
  // Row y of the first component, which must be upsampled if others have more samples.
  const uint8_t* first_row(int y) { return full_row(0, y); }
  // Row y of component c's samples, not upsampled.
  const uint8_t* sample_row(int c, int y) { return row(c, y); }

 private:
  enum class Upsampling : uint8_t { none, h2v1, h2v2, h1v2, nearest };
  struct Plane {
    std::vector<uint8_t> samples;
    ptrdiff_t stride = 0;
    int n_rows = 0;    // that `samples` holds; image row y sits in row y % n_rows
    int row_mask = 0;  // that row is y & row_mask; 0 where no mask says so
    int block_size = 8;
    ptrdiff_t first = 0;  // column where the rows begin: see narrow()
    Upsampling upsampling = Upsampling::none;
    size_t size() const { return static_cast<size_t>(stride) * static_cast<size_t>(n_rows); }
  };
  uint8_t* row(int c, int y) {
    Plane& plane = planes_[c];
    const int row = plane.row_mask != 0 ? y & plane.row_mask : y % plane.n_rows;
    return plane.samples.data() + row * plane.stride + plane.first;
  }
  void set_up(const ScaledFrame& scaled, bool whole_image, ColorModel color, const Kernels& kernels);
  Upsampling choose(const Component& c) const;
  const uint8_t* full_row(int c, int y);
  bool is_plain_420() const;
  void write_420_row(int y, uint8_t* rgb);

  Frame frame_;
  int mcu_width_ = 8;  // pixels
  bool fancy_ = true;  // triangle filters
  ColorModel color_ = ColorModel::unknown;
  const Kernels* kernels_ = nullptr;
  Plane planes_[kMaxComponents];
  std::vector<uint8_t> upsampled_[kMaxComponents];  // one row each
};

}  // namespace pac::jpeg
