#include <cstring>

#include "mpeg1/mpeg1.h"

namespace pac::mpeg1 {
namespace {

void copy_plane(const PlaneView<const uint8_t>& from, GrayImage& to) {
  for (int y = 0; y < from.height; ++y) std::memcpy(to.row(y), from.row(y), static_cast<size_t>(from.width));
}

}  // namespace

FrameView view_of(const Frame420& frame) {
  return {frame.y.view(), frame.cb.view(), frame.cr.view()};
}

Frame420 copy_of(const FrameView& frame) {
  Frame420 copy(frame.width(), frame.height());
  copy_plane(frame.y, copy.y);
  copy_plane(frame.cb, copy.cb);
  copy_plane(frame.cr, copy.cr);
  return copy;
}

int macroblock_columns(int width) {
  return (width + 15) / 16;
}
int macroblock_rows(int height) {
  return (height + 15) / 16;
}

}  // namespace pac::mpeg1
