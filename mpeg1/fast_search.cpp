#include <algorithm>
#include <bit>
#include <cstdlib>

#include "mpeg1/motion_search.h"

namespace pac::mpeg1 {
namespace {

constexpr int kMaxSteps = 24, kMaxTried = 16;
constexpr uint32_t kPoorSad = 2000;  // 8 a sample: from which on the search looks further
constexpr int kDx[4] = {1, 0, -1, 0}, kDy[4] = {0, 1, 0, -1};
constexpr int kEnoughNeighbors = 2;  // that have the vector

class FastSearch {
 public:
  FastSearch(const SearchInput& input, const FastSearchOptions& options)
      : in_(input),
        options_(options),
        still_(input.reference.data[0] + 16 * input.row * input.reference.stride[0] + 16 * input.column),
        stride_(input.reference.stride[0]) {}

  SearchResult run() {
    start_still();
    try_candidates();
    if (best_.sad < options_.good_sad) return best_;
    const bool is_poor = best_.sad > kPoorSad;
    if (is_poor) walk(8);
    // Neighbors that agree on a half sample are near the motion: a smaller step from it finds more than a larger one.
    const bool is_near = options_.believes_neighbors && !is_poor && is_half(best_.vector) && is_of_neighbors();
    const bool moved = walk(is_near ? 1 : 2);
    if (is_near || (options_.believes_neighbors && !moved && is_of_neighbors())) return best_;
    refine();
    return best_;
  }

 private:
  // Neither vector leaves the range of an f_code: their difference is in the table.
  uint32_t bits_cost(int x, int y) const {
    const int dx = std::abs(x - in_.predicted.x_halfpel), dy = std::abs(y - in_.predicted.y_halfpel);
    return (static_cast<uint32_t>(in_.bits_of_difference[dx] + in_.bits_of_difference[dy]) * in_.lambda_q4) >> 4;
  }

  void start_still() {
    const uint32_t cost = options_.still_sad + bits_cost(0, 0);
    best_.sad = options_.still_sad;
    best_.cost = cost - std::min(cost, options_.still_bonus);
  }

  const uint8_t* reference_at(int x, int y) const { return still_ + (y >> 1) * stride_ + (x >> 1); }

  // A vector inside the range. True where it is the best so far.
  bool try_vector(int x, int y) {
    const auto sad16 = in_.kernels->sad16_half[(x & 1) + 2 * (y & 1)];
    return weigh(x, y, sad16(in_.source, in_.source_stride, reference_at(x, y), stride_));
  }
  bool weigh(int x, int y, uint32_t sad) {
    const uint32_t cost = sad + bits_cost(x, y);
    if (cost >= best_.cost) return false;
    best_.vector = {static_cast<int16_t>(x), static_cast<int16_t>(y)};
    best_.sad = sad, best_.cost = cost;
    return true;
  }

  void try_candidates() {
    uint32_t tried[kMaxTried + 1];
    int n_tried = 0;
    tried[n_tried++] = 0;  // the zero vector
    for (int i = 0; i < in_.n_candidates && n_tried <= kMaxTried; ++i) {
      const MotionVector v = in_.range.clamp(in_.candidates[i]);
      const auto number = std::bit_cast<uint32_t>(v);
      bool is_new = true;
      for (int k = 0; k < n_tried && is_new; ++k) is_new = number != tried[k];
      if (!is_new) continue;
      tried[n_tried++] = number;
      try_vector(v.x_halfpel, v.y_halfpel);
    }
  }
  static bool is_half(MotionVector v) { return ((v.x_halfpel | v.y_halfpel) & 1) != 0; }
  bool is_of_neighbors() const {
    return std::count(in_.candidates, in_.candidates + in_.n_candidates, best_.vector) >= kEnoughNeighbors;
  }

  // Downhill in a diamond of that radius (half samples), without looking back to where it came from.
  bool walk(int radius) {
    int came_from = -1;
    for (int step = 0; step < kMaxSteps; ++step) {
      const int moved = step == 0 && radius % 2 == 0 && !is_half(best_.vector) ? look_around(best_.vector, radius)
                                                                               : look(best_.vector, radius, came_from);
      if (moved < 0) return step > 0;
      came_from = moved ^ 2;
    }
    return true;
  }
  // Which of the four directions, but for one, is the best so far; -1: none.
  int look(MotionVector center, int radius, int came_from) {
    int moved = -1;
    for (int direction = 0; direction < 4; ++direction) {
      const int x = center.x_halfpel + radius * kDx[direction], y = center.y_halfpel + radius * kDy[direction];
      if (direction != came_from && in_.range.contains(x, y) && try_vector(x, y)) moved = direction;
    }
    return moved;
  }
  // All four at once, of whole samples.
  int look_around(MotionVector center, int radius) {
    const int x = center.x_halfpel, y = center.y_halfpel;
    if (!in_.range.contains(x - radius, y - radius) || !in_.range.contains(x + radius, y + radius))
      return look(center, radius, -1);
    const uint8_t* references[4];
    for (int i = 0; i < 4; ++i) references[i] = reference_at(x + radius * kDx[i], y + radius * kDy[i]);
    uint32_t sads[4];
    in_.kernels->sad16_x4(in_.source, in_.source_stride, references, stride_, sads);
    int moved = -1;
    for (int i = 0; i < 4; ++i)
      if (weigh(x + radius * kDx[i], y + radius * kDy[i], sads[i])) moved = i;
    return moved;
  }

  void refine() {
    const MotionVector center = best_.vector;
    const auto try_half = [&](int dx, int dy) {
      const int x = center.x_halfpel + dx, y = center.y_halfpel + dy;
      if (in_.range.contains(x, y)) try_vector(x, y);
    };
    refine_by_halves(best_.vector, try_half);
  }

  const SearchInput& in_;
  const FastSearchOptions& options_;
  const uint8_t* still_;  // where the zero vector leads
  ptrdiff_t stride_;
  SearchResult best_;
};

}  // namespace

SearchResult search_fast(const SearchInput& input, const FastSearchOptions& options) {
  return FastSearch(input, options).run();
}

}  // namespace pac::mpeg1
