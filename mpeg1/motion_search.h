// Motion estimation of one macroblock: predictors, a pattern that walks downhill, half-sample refinement.
#pragma once

#include <algorithm>
#include <cstdint>

#include "base/kernels/kernels.h"
#include "mpeg1/mpeg1.h"
#include "mpeg1/predict.h"

namespace pac::mpeg1 {

// Vectors that keep the prediction inside the picture and inside the largest f_code in use, both ends included.
struct VectorRange {
  int x_low, x_high, y_low, y_high;  // half samples
  MotionVector clamp(MotionVector v) const {
    return {static_cast<int16_t>(std::clamp(int{v.x_halfpel}, x_low, x_high)),
            static_cast<int16_t>(std::clamp(int{v.y_halfpel}, y_low, y_high))};
  }
  bool contains(int x, int y) const { return x >= x_low && x <= x_high && y >= y_low && y <= y_high; }
};
VectorRange vector_range(const Planes& reference, int column, int row, int f_code);

struct SearchOptions {
  int max_steps = 8;      // of the pattern
  bool wide = false;      // a pattern of twice the size before it
  bool hadamard = false;  // half samples by SATD instead of SAD
};

struct SearchInput {
  const MotionKernels* kernels;
  const uint8_t* source;  // of the macroblock
  ptrdiff_t source_stride;
  Planes reference;
  int column, row;
  VectorRange range;
  MotionVector predicted;          // that the stream codes the difference from
  const MotionVector* candidates;  // any vectors; clamped here
  int n_candidates;
  const MotionVector* far_vector = nullptr;  // where another search may begin; not in search_fast()
  uint32_t lambda_q4;                        // cost of a bit in units of SAD / 16
  const uint8_t* bits_of_difference;         // vector bits by |difference|, indexed 0..kMaxDifference
};
constexpr int kMaxDifference = 4095;

struct SearchResult {
  MotionVector vector;
  uint32_t sad = 0;   // of the best vector, SATD where asked for
  uint32_t cost = 0;  // with the vector's bits
  // By SATD only: the next best vector around it, and what it costs.
  MotionVector runner_up;
  uint32_t runner_up_cost = ~uint32_t{0};
};

// Half samples around `best`: the better neighbor to the side, the better one up or down, then the corners beside the
// best. try_half(dx, dy) weighs the place at that distance from where `best` is at first, and moves `best` there if
// better.
template <class Try>
void refine_by_halves(const MotionVector& best, Try&& try_half) {
  const MotionVector center = best;
  try_half(-1, 0), try_half(1, 0), try_half(0, -1), try_half(0, 1);
  const int dx = best.x_halfpel - center.x_halfpel, dy = best.y_halfpel - center.y_halfpel;
  if (dx != 0)
    try_half(dx, -1), try_half(dx, 1);
  else if (dy != 0)
    try_half(-1, dy), try_half(1, dy);
}

SearchResult search_motion(const SearchInput& input, const SearchOptions& options);

// The search of Effort::fast: candidates as they are, half samples too; downhill from the best at its phase; half
// samples around it only where the neighbors do not know better.
struct FastSearchOptions {
  uint32_t still_sad = 0;    // of the zero vector
  uint32_t still_bonus = 0;  // what the zero vector is favored by, as it may be skipped
  uint32_t good_sad = 0;     // from which on the search ends
  bool believes_neighbors = true;
};
SearchResult search_fast(const SearchInput& input, const FastSearchOptions& options);

}  // namespace pac::mpeg1
