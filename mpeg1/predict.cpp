#include "mpeg1/predict.h"

#include <algorithm>
#include <cstring>

#include "mpeg1/motion_vector.h"

namespace pac::mpeg1 {
namespace {

// A block of size x size samples (16 or 8) at (x, y) + vector/2.
struct BlockPlace {
  int x, y, size, plane_width, plane_height;
};

// The rectangle that a prediction reads leaves the plane: a copy of it with the edge repeated.
constexpr ptrdiff_t kPatchStride = 32;
struct Patch {
  uint8_t samples[17 * kPatchStride];
};
void make_patch(const uint8_t* plane, ptrdiff_t stride, const BlockPlace& place, int left, int top, Patch& patch) {
  for (int y = 0; y <= place.size; ++y) {
    const uint8_t* row = plane + ptrdiff_t{std::clamp(top + y, 0, place.plane_height - 1)} * stride;
    for (int x = 0; x <= place.size; ++x)
      patch.samples[y * kPatchStride + x] = row[std::clamp(left + x, 0, place.plane_width - 1)];
  }
}

void predict_block(const MotionKernels& kernels, const uint8_t* plane, ptrdiff_t stride, const BlockPlace& place,
                   MotionVector vector, uint8_t* target, ptrdiff_t target_stride) {
  const int half_x = vector.x_halfpel & 1, half_y = vector.y_halfpel & 1;
  const int left = place.x + (vector.x_halfpel >> 1), top = place.y + (vector.y_halfpel >> 1);
  const auto* predict = place.size == 16 ? kernels.predict16 : kernels.predict8;
  const int kind = half_x + 2 * half_y;
  const bool inside = left >= 0 && top >= 0 && left + place.size + half_x <= place.plane_width &&
                      top + place.size + half_y <= place.plane_height;
  if (inside) {
    predict[kind](plane + top * stride + left, stride, target, target_stride, place.size);
    return;
  }
  Patch patch;
  make_patch(plane, stride, place, left, top, patch);
  predict[kind](patch.samples, kPatchStride, target, target_stride, place.size);
}

// A few units of a fixed size: without the call that a size unknown to the compiler takes.
constexpr int kLongRun = 8;
template <int kBytes>
void copy_units(const uint8_t* from, uint8_t* to, int count) {
  for (int i = 0; i < count; ++i) std::memcpy(to + i * kBytes, from + i * kBytes, kBytes);
}

}  // namespace

void predict_macroblock(const MotionKernels& kernels, const Planes& reference, int column, int row, MotionVector vector,
                        const Planes& target, int target_column, int target_row) {
  const MotionVector chroma = chroma_vector(vector);
  const int left = 16 * column + (vector.x_halfpel >> 1), top = 16 * row + (vector.y_halfpel >> 1);
  const int half_x = vector.x_halfpel & 1, half_y = vector.y_halfpel & 1;
  if (left >= 0 && top >= 0 && left + 16 + half_x <= reference.width && top + 16 + half_y <= reference.height) {
    // Half the vector, toward zero, from half the position: chroma is inside, too.
    kernels.predict16[half_x + 2 * half_y](reference.data[0] + top * reference.stride[0] + left, reference.stride[0],
                                           target.at(0, target_column, target_row), target.stride[0], 16);
    const ptrdiff_t x = 8 * column + (chroma.x_halfpel >> 1), y = 8 * row + (chroma.y_halfpel >> 1);
    const int kind = (chroma.x_halfpel & 1) + 2 * (chroma.y_halfpel & 1);
    for (const int plane : {1, 2})
      kernels.predict8[kind](reference.data[plane] + y * reference.stride[plane] + x, reference.stride[plane],
                             target.at(plane, target_column, target_row), target.stride[plane], 8);
    return;
  }
  predict_block(kernels, reference.data[0], reference.stride[0],
                {16 * column, 16 * row, 16, reference.width, reference.height}, vector,
                target.at(0, target_column, target_row), target.stride[0]);
  for (const int plane : {1, 2})
    predict_block(kernels, reference.data[plane], reference.stride[plane],
                  {8 * column, 8 * row, 8, reference.width / 2, reference.height / 2}, chroma,
                  target.at(plane, target_column, target_row), target.stride[plane]);
}

void average_macroblock(const MotionKernels& kernels, const Planes& reference, int column, int row, MotionVector vector,
                        const Planes& target) {
  MacroblockSamples second;
  const Planes planes = second.planes();
  predict_macroblock(kernels, reference, column, row, vector, planes, 0, 0);
  for (const int plane : {0, 1, 2}) {
    const int size = plane == 0 ? 16 : 8;
    kernels.average(target.at(plane, column, row), target.stride[plane], planes.data[plane], planes.stride[plane], size,
                    size);
  }
}

void copy_macroblocks(const Planes& reference, int column, int row, int count, const Planes& target) {
  for (const int plane : {0, 1, 2}) {
    const int size = plane == 0 ? 16 : 8;
    const uint8_t* from = reference.at(plane, column, row);
    uint8_t* to = target.at(plane, column, row);
    for (int y = 0; y < size; ++y) {
      if (count > kLongRun)
        std::memcpy(to, from, static_cast<size_t>(size * count));
      else if (size == 16)
        copy_units<16>(from, to, count);
      else
        copy_units<8>(from, to, count);
      from += reference.stride[plane];
      to += target.stride[plane];
    }
  }
}

void fill_planes(const FrameView& frame, const Planes& target) {
  const PlaneView<const uint8_t> sources[3] = {frame.y, frame.cb, frame.cr};
  for (int plane = 0; plane < 3; ++plane) {
    const PlaneView<const uint8_t>& source = sources[plane];
    const int width = plane == 0 ? target.width : target.width / 2;
    const int height = plane == 0 ? target.height : target.height / 2;
    for (int y = 0; y < height; ++y) {
      const uint8_t* from = source.row(std::min(y, source.height - 1));
      uint8_t* to = target.data[plane] + y * target.stride[plane];
      std::memcpy(to, from, static_cast<size_t>(source.width));
      if (width > source.width)
        std::memset(to + source.width, from[source.width - 1], static_cast<size_t>(width - source.width));
    }
  }
}

Planes whole_macroblocks(const Frame420& frame, Frame420& copy) {
  if (frame.width() % 16 == 0 && frame.height() % 16 == 0) return Planes::of(const_cast<Frame420&>(frame));
  const int width = (frame.width() + 15) / 16 * 16, height = (frame.height() + 15) / 16 * 16;
  if (copy.width() != width || copy.height() != height) copy = Frame420(width, height);
  const Planes planes = Planes::of(copy);
  fill_planes(view_of(frame), planes);
  return planes;
}

}  // namespace pac::mpeg1
