// Motion vectors: their range, their differential code, their halves for chroma [11172-2 2.4.4.2].
#pragma once

#include <cstdint>

#include "mpeg1/mpeg1.h"

namespace pac::mpeg1 {

// One component's difference as the stream codes it: motion_code -16..16 and motion_r of f_code - 1 bits.
struct MotionCode {
  int code = 0;
  int r = 0;
};

// Both ends fold the sum of prediction and difference into -16 f .. 16 f - 1, with f = 2^(f_code - 1).
inline int wrap_vector(int value, int r_size) {
  const int range = 32 << r_size;
  const int low = -(range >> 1);
  return ((value - low) & (range - 1)) + low;
}

inline MotionCode motion_code_from(int vector, int predicted, int r_size) {
  const int difference = wrap_vector(vector - predicted, r_size);
  if (difference == 0) return {};
  const int magnitude = (difference < 0 ? -difference : difference) - 1;
  const int code = (magnitude >> r_size) + 1;
  return {difference < 0 ? -code : code, magnitude & ((1 << r_size) - 1)};
}

inline int vector_from(MotionCode motion, int predicted, int r_size) {
  if (motion.code == 0) return predicted;
  const int magnitude = ((motion.code < 0 ? -motion.code : motion.code) - 1) * (1 << r_size) + motion.r + 1;
  return wrap_vector(predicted + (motion.code < 0 ? -magnitude : magnitude), r_size);
}

// The chroma vector, in half samples of chroma: truncated toward zero.
inline MotionVector chroma_vector(MotionVector luma) {
  return {static_cast<int16_t>(luma.x_halfpel / 2), static_cast<int16_t>(luma.y_halfpel / 2)};
}

}  // namespace pac::mpeg1
