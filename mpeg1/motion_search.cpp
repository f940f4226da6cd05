#include "mpeg1/motion_search.h"

#include <algorithm>
#include <bit>
#include <cstdlib>

namespace pac::mpeg1 {
namespace {

class Search {
 public:
  Search(const SearchInput& input, const SearchOptions& options)
      : in_(input),
        options_(options),
        still_(input.reference.data[0] + 16 * input.row * input.reference.stride[0] + 16 * input.column),
        stride_(input.reference.stride[0]) {}

  SearchResult run() {
    try_candidates();
    if (options_.wide) walk(4);
    walk(2);
    look_far();
    refine();
    return best_;
  }

 private:
  const uint8_t* at(int x, int y) const {  // half samples, rounded down
    return still_ + (y >> 1) * stride_ + (x >> 1);
  }
  // Neither vector leaves the range of an f_code: their difference is in the table.
  uint32_t bits_cost(int x, int y) const {
    const int dx = std::abs(x - in_.predicted.x_halfpel), dy = std::abs(y - in_.predicted.y_halfpel);
    return (static_cast<uint32_t>(in_.bits_of_difference[dx] + in_.bits_of_difference[dy]) * in_.lambda_q4) >> 4;
  }

  // A vector of whole samples inside the range.
  void try_whole(int x, int y) {
    const uint32_t sad = in_.kernels->sad16(in_.source, in_.source_stride, at(x, y), stride_);
    accept(x, y, sad);
  }
  void accept(int x, int y, uint32_t sad) {
    const uint32_t cost = sad + bits_cost(x, y);
    if (cost >= best_.cost) return;
    best_.vector = {static_cast<int16_t>(x), static_cast<int16_t>(y)};
    best_.sad = sad, best_.cost = cost;
  }

  void try_candidates() {
    best_.cost = ~uint32_t{0};
    try_whole(0, 0);
    constexpr int kMost = 32;
    uint32_t tried[kMost];
    int n_tried = 0;
    tried[n_tried++] = 0;
    for (int i = 0; i < in_.n_candidates; ++i) {
      MotionVector v = in_.range.clamp(in_.candidates[i]);
      v.x_halfpel = static_cast<int16_t>(v.x_halfpel & ~1);  // the range's ends are even
      v.y_halfpel = static_cast<int16_t>(v.y_halfpel & ~1);
      const auto number = std::bit_cast<uint32_t>(v);
      bool is_new = true;
      for (int k = 0; k < n_tried && is_new; ++k) is_new = number != tried[k];
      if (!is_new) continue;
      if (n_tried < kMost) tried[n_tried++] = number;
      try_whole(v.x_halfpel, v.y_halfpel);
    }
  }

  // Downhill in a diamond of that radius (half samples), without looking back to where it came from.
  void walk(int radius) {
    static constexpr int kDx[4] = {1, 0, -1, 0}, kDy[4] = {0, 1, 0, -1};
    int came_from = -1;
    for (int step = 0; step < options_.max_steps; ++step) {
      const MotionVector center = best_.vector;
      int moved = -1;
      for (int direction = 0; direction < 4; ++direction) {
        if (direction == came_from) continue;
        const int x = center.x_halfpel + radius * kDx[direction], y = center.y_halfpel + radius * kDy[direction];
        if (!in_.range.contains(x, y)) continue;
        const uint32_t before = best_.cost;
        try_whole(x, y);
        if (best_.cost < before) moved = direction;
      }
      if (moved < 0) return;
      came_from = moved ^ 2;
    }
  }

  // Another descent, which must be clearly better: what lies far from the neighbors' vectors costs them bits, too.
  void look_far() {
    constexpr uint32_t kLeastGainPercent = 5, kLeastGainBits = 10;
    if (in_.far_vector == nullptr) return;
    const SearchResult near = best_;
    const MotionVector v = in_.range.clamp(*in_.far_vector);
    best_.cost = ~uint32_t{0};
    try_whole(v.x_halfpel & ~1, v.y_halfpel & ~1);
    if (best_.vector == near.vector || best_.cost > 2 * near.cost) {
      best_ = near;
      return;
    }
    walk(2);
    const uint32_t least_gain = near.cost * kLeastGainPercent / 100 + (kLeastGainBits * in_.lambda_q4 >> 4);
    if (best_.cost + least_gain >= near.cost) best_ = near;
  }

  uint32_t half_distance(int x, int y) const {
    const int kind = (x & 1) + 2 * (y & 1);
    if (!options_.hadamard) return in_.kernels->sad16_half[kind](in_.source, in_.source_stride, at(x, y), stride_);
    alignas(64) uint8_t prediction[256];
    in_.kernels->predict16[kind](at(x, y), stride_, prediction, 16, 16);
    return in_.kernels->satd16(in_.source, in_.source_stride, prediction, 16);
  }

  void refine() {
    const MotionVector center = best_.vector;
    if (options_.hadamard) {
      best_.sad = half_distance(center.x_halfpel, center.y_halfpel);
      best_.cost = best_.sad + bits_cost(center.x_halfpel, center.y_halfpel);
    }
    const auto try_half = [&](int dx, int dy) {
      const int x = center.x_halfpel + dx, y = center.y_halfpel + dy;
      if (in_.range.contains(x, y)) accept(x, y, half_distance(x, y));
    };
    if (options_.hadamard) {
      for (int i = 0; i < 9; ++i) {
        const int x = center.x_halfpel + i % 3 - 1, y = center.y_halfpel + i / 3 - 1;
        if (i != 4 && in_.range.contains(x, y)) accept_or_note(x, y, half_distance(x, y));
      }
      return;
    }
    refine_by_halves(best_.vector, try_half);
  }
  void accept_or_note(int x, int y, uint32_t distance) {
    const SearchResult before = best_;
    accept(x, y, distance);
    const bool is_best = best_.vector != before.vector;
    const uint32_t cost = is_best ? before.cost : distance + bits_cost(x, y);
    if (cost >= best_.runner_up_cost) return;
    best_.runner_up = is_best ? before.vector : MotionVector{static_cast<int16_t>(x), static_cast<int16_t>(y)};
    best_.runner_up_cost = cost;
  }

  const SearchInput& in_;
  const SearchOptions& options_;
  const uint8_t* still_;  // where the zero vector leads
  ptrdiff_t stride_;
  SearchResult best_;
};

}  // namespace

VectorRange vector_range(const Planes& reference, int column, int row, int f_code) {
  const int reach = 16 << (f_code - 1);
  return {std::max(-32 * column, -reach), std::min(2 * (reference.width - 16 - 16 * column), reach - 2),
          std::max(-32 * row, -reach), std::min(2 * (reference.height - 16 - 16 * row), reach - 2)};
}

SearchResult search_motion(const SearchInput& input, const SearchOptions& options) {
  return Search(input, options).run();
}

}  // namespace pac::mpeg1
