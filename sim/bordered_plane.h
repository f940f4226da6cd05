// Planes of signed samples that can be read beyond their edges.
#pragma once

#include <cstdint>

#include "base/image.h"

namespace pac::sim {

// A plane of 16-bit samples with a border of kBorder on all sides that repeats the edge.
class BorderedPlane {
 public:
  static constexpr int kBorder = 8;
  BorderedPlane() = default;
  BorderedPlane(int width, int height) : image_(width + 2 * kBorder, height + 2 * kBorder) {}
  int width() const { return image_.width() - 2 * kBorder; }
  int height() const { return image_.height() - 2 * kBorder; }
  ptrdiff_t stride() const { return image_.stride(); }
  int16_t* row(int y) { return image_.row(y + kBorder) + kBorder; }
  const int16_t* row(int y) const { return image_.row(y + kBorder) + kBorder; }
  void extend();  // fills the border

 private:
  Image<int16_t, 1> image_;
};

}  // namespace pac::sim
