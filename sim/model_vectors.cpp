#include "sim/model_vectors.h"

#include <algorithm>
#include <cstdlib>

namespace pac::sim {

namespace {

// From a pixel to where it was, in 1/64 pixel.
struct Step {
  int x = 0, y = 0;
};

int distance(const Step& a, const Step& b) {
  return std::abs(a.x - b.x) + std::abs(a.y - b.y);
}

mpeg1::MotionVector vector_of(const Step& step) {
  const auto half_samples = [](int v) {
    constexpr int kMost = 4096;  // farther than any f_code reaches
    return static_cast<int16_t>(std::clamp((v + 16) >> 5, -kMost, kMost));
  };
  return {half_samples(step.x), half_samples(step.y)};
}

// The points of one macroblock that were somewhere, the one in its middle last.
std::vector<Step> steps_of(const Flow& flow, int left, int top) {
  std::vector<Step> steps;
  const auto add = [&](int x, int y) {
    const int at_x = std::min(left + x, flow.x_64.width() - 1), at_y = std::min(top + y, flow.x_64.height() - 1);
    const int32_t x_64 = flow.x_64.row(at_y)[at_x], y_64 = flow.y_64.row(at_y)[at_x];
    constexpr int32_t kFar = 1 << 24;  // sums of such steps fit; farther away, or nowhere, is no use
    const bool is_near = -kFar < x_64 && x_64 < kFar && -kFar < y_64 && y_64 < kFar;
    if (is_near) steps.push_back({x_64 - 64 * at_x, y_64 - 64 * at_y});
  };
  for (int y = 2; y < 16; y += 4)
    for (int x = 2; x < 16; x += 4) add(x, y);
  add(8, 8);
  return steps;
}

// By x and by y on their own.
Step median(const std::vector<Step>& steps) {
  std::vector<int> x, y;
  for (const Step& step : steps) {
    x.push_back(step.x);
    y.push_back(step.y);
  }
  const auto middle = static_cast<ptrdiff_t>(steps.size() / 2);
  std::nth_element(x.begin(), x.begin() + middle, x.end());
  std::nth_element(y.begin(), y.begin() + middle, y.end());
  return {x[static_cast<size_t>(middle)], y[static_cast<size_t>(middle)]};
}

template <class Measure>
Step largest(const std::vector<Step>& steps, Measure&& measure) {
  return *std::max_element(steps.begin(), steps.end(),
                           [&](const Step& a, const Step& b) { return measure(a) < measure(b); });
}

}  // namespace

std::vector<mpeg1::MotionVector> vectors_of(const Flow& flow) {
  std::vector<mpeg1::MotionVector> vectors;
  for (int top = 0; top < flow.x_64.height(); top += 16)
    for (int left = 0; left < flow.x_64.width(); left += 16) {
      const std::vector<Step> steps = steps_of(flow, left, top);
      if (steps.empty()) {
        vectors.insert(vectors.end(), kModelVectors, mpeg1::MotionVector{});
        continue;
      }
      const Step typical = median(steps);
      const Step other = largest(steps, [&](const Step& s) { return distance(s, typical); });
      const Step third =
          largest(steps, [&](const Step& s) { return std::min(distance(s, typical), distance(s, other)); });
      for (const Step& step : {typical, other, third, steps.back()}) vectors.push_back(vector_of(step));
    }
  return vectors;
}

}  // namespace pac::sim
