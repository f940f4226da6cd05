#include "mpeg1/predict.h"

#include <algorithm>
#include <cstring>

#include "mpeg1/motion_vector.h"

namespace pac::mpeg1 {
namespace {

// The rectangle that a prediction reads leaves the plane: a copy of it with the edge repeated.
constexpr ptrdiff_t kPatchStride = 32;
struct Patch {
  uint8_t samples[17 * kPatchStride];
};
// (size + 1) x (size + 1) samples from (left, top) on.
void make_patch(const Planes& reference, int plane, int left, int top, int size, Patch& patch) {
  const int right = (plane == 0 ? reference.width : reference.width / 2) - 1;
  const int bottom = (plane == 0 ? reference.height : reference.height / 2) - 1;
  for (int y = 0; y <= size; ++y) {
    const uint8_t* row = reference.data[plane] + std::clamp(top + y, 0, bottom) * reference.stride[plane];
    for (int x = 0; x <= size; ++x) patch.samples[y * kPatchStride + x] = row[std::clamp(left + x, 0, right)];
  }
}

// What the prediction of a macroblock reads: from where in luma and chroma, and which half samples.
struct ReferencePlace {
  int x, y, kind;
};
ReferencePlace place_of(int left, int top, MotionVector vector) {
  return {left + (vector.x_halfpel >> 1), top + (vector.y_halfpel >> 1),
          (vector.x_halfpel & 1) + 2 * (vector.y_halfpel & 1)};
}

void predict_across_edge(const MotionKernels& kernels, const Planes& reference, const ReferencePlace& luma,
                         const ReferencePlace& chroma, const Planes& target, int column, int row) {
  Patch patches[2];
  make_patch(reference, 0, luma.x, luma.y, 16, patches[0]);
  kernels.predict16[luma.kind](patches[0].samples, kPatchStride, target.at(0, column, row), target.stride[0], 16);
  make_patch(reference, 1, chroma.x, chroma.y, 8, patches[0]);
  make_patch(reference, 2, chroma.x, chroma.y, 8, patches[1]);
  const uint8_t* const from[2] = {patches[0].samples, patches[1].samples};
  uint8_t* const to[2] = {target.at(1, column, row), target.at(2, column, row)};
  kernels.predict8_pair[chroma.kind](from, kPatchStride, to, target.stride[1]);
}

// Blocks of a fixed size: without loops, and without the call that a size unknown to the compiler takes.
template <int kSize>
void copy_block(const uint8_t* from, ptrdiff_t from_stride, uint8_t* to, ptrdiff_t to_stride) {
  for (int y = 0; y < kSize; ++y) std::memcpy(to + y * to_stride, from + y * from_stride, kSize);
}
void copy_macroblock(const Planes& reference, int column, int row, const Planes& target) {
  copy_block<16>(reference.at(0, column, row), reference.stride[0], target.at(0, column, row), target.stride[0]);
  copy_block<8>(reference.at(1, column, row), reference.stride[1], target.at(1, column, row), target.stride[1]);
  copy_block<8>(reference.at(2, column, row), reference.stride[2], target.at(2, column, row), target.stride[2]);
}
constexpr int kLongRun = 4;

}  // namespace

void predict_macroblock(const MotionKernels& kernels, const Planes& reference, int column, int row, MotionVector vector,
                        const Planes& target, int target_column, int target_row) {
  PAC_ASSERT(reference.stride[1] == reference.stride[2] && target.stride[1] == target.stride[2]);
  const ReferencePlace luma = place_of(16 * column, 16 * row, vector);
  const ReferencePlace chroma = place_of(8 * column, 8 * row, chroma_vector(vector));
  // Inside or not: half the vector, toward zero, from half the position leads chroma inside where luma is.
  if (luma.x < 0 || luma.y < 0 || luma.x + 16 + (luma.kind & 1) > reference.width ||
      luma.y + 16 + (luma.kind >> 1) > reference.height) [[unlikely]]
    return predict_across_edge(kernels, reference, luma, chroma, target, target_column, target_row);
  kernels.predict16[luma.kind](reference.data[0] + luma.y * reference.stride[0] + luma.x, reference.stride[0],
                               target.at(0, target_column, target_row), target.stride[0], 16);
  const ptrdiff_t at = chroma.y * reference.stride[1] + chroma.x;
  const uint8_t* const from[2] = {reference.data[1] + at, reference.data[2] + at};
  uint8_t* const to[2] = {target.at(1, target_column, target_row), target.at(2, target_column, target_row)};
  kernels.predict8_pair[chroma.kind](from, reference.stride[1], to, target.stride[1]);
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
  if (count < kLongRun) {
    for (int i = 0; i < count; ++i) copy_macroblock(reference, column + i, row, target);
    return;
  }
  for (const int plane : {0, 1, 2}) {
    const int size = plane == 0 ? 16 : 8;
    const uint8_t* from = reference.at(plane, column, row);
    uint8_t* to = target.at(plane, column, row);
    for (int y = 0; y < size; ++y, from += reference.stride[plane], to += target.stride[plane])
      std::memcpy(to, from, static_cast<size_t>(size * count));
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
