#include "mpeg1/lookahead.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/exact_math.h"
#include "mpeg1/coarse_motion.h"
#include "mpeg1/motion_search.h"
#include "mpeg1/slice_writer.h"

namespace pac::mpeg1 {
namespace {

constexpr int kFCode = 4;             // vectors stay in its range
constexpr uint32_t kVectorCost = 32;  // of a vector's bit, in SAD / 16
constexpr uint32_t kStillSad = 96;    // of a macroblock that needs no search

// Errors of prediction (mean squares) that are coded anew take the errors before them along only in part: half at
// kCodedError quantizer_scale^2. Below kNoise what a macroblock varies by is not told from noise.
constexpr double kCodedError = 0.5, kNoise = 1;

// Squared errors would be in balance at quantizer_scale / sqrt(worth), if what is predicted were not coded again as
// soon as its reference is finer than itself: measured, the cube root gave most.
constexpr double kExponent = -1.0 / 3;

// Of what a macroblock is worth, no more goes to the picture before: what many pictures from now on repeat will hardly
// be what it is now.
constexpr float kMostPassed = 10;

}  // namespace

struct Lookahead::Step {
  Planes before, source;
  const MotionVector* coarse_vectors = nullptr;
  int coarse_columns = 0;
  double quantizer_scale = 1;
  const uint8_t* bits_of_difference = nullptr;
  const Vectors* last = nullptr;  // of the step before, or null
  const MotionKernels* kernels = nullptr;
};

MotionVector Lookahead::search(const Step& step, const Band& band, int column, int row, const Vectors& vectors) const {
  if (step.kernels->sad16(step.source.at(0, column, row), step.source.stride[0], step.before.at(0, column, row),
                          step.before.stride[0]) < kStillSad)
    return {};
  const auto at = [&](const Vectors& of, int dx, int dy) {
    return of[static_cast<size_t>((row + dy) * columns_ + column + dx)];
  };
  MotionVector candidates[6];
  int n = 0;
  if (column > 0) candidates[n++] = at(vectors, -1, 0);
  if (row > band.first_row) candidates[n++] = at(vectors, 0, -1);
  if (row > band.first_row && column + 1 < columns_) candidates[n++] = at(vectors, 1, -1);
  if (step.last != nullptr) {
    candidates[n++] = at(*step.last, 0, 0);
    if (column + 1 < columns_) candidates[n++] = at(*step.last, 1, 0);
    if (row + 1 < rows_) candidates[n++] = at(*step.last, 0, 1);
  }
  SearchInput input;
  input.kernels = step.kernels;
  input.source = step.source.at(0, column, row);
  input.source_stride = step.source.stride[0];
  input.reference = step.before;
  input.column = column;
  input.row = row;
  input.range = vector_range(step.before, column, row, kFCode);
  input.predicted = column > 0 ? candidates[0] : MotionVector{};
  input.candidates = candidates;
  input.n_candidates = n;
  if (step.coarse_vectors != nullptr)
    input.far_vector = step.coarse_vectors + (row / 2 * step.coarse_columns + column / 2);
  input.lambda_q4 = kVectorCost;
  input.bits_of_difference = step.bits_of_difference;
  SearchOptions options;
  options.max_steps = 16;
  return search_motion(input, options).vector;
}

// How much of the errors in its reference a macroblock takes over that is predicted by `vector`.
float Lookahead::share(const Step& step, int column, int row, MotionVector vector) const {
  MacroblockSamples samples;
  predict_macroblock(*step.kernels, step.before, column, row, vector, samples.planes(), 0, 0);
  const uint8_t* source = step.source.at(0, column, row);
  const ptrdiff_t stride = step.source.stride[0];
  const double error = step.kernels->sse(source, stride, samples.y, 16, 16, 16) / 256.0;
  uint32_t sum = 0, sum_of_squares = 0;
  step.kernels->moments16(source, stride, &sum, &sum_of_squares);
  const double variance = (sum_of_squares - static_cast<double>(sum) * sum / 256) / 256;
  const double of_motion = 1 - std::sqrt(error / (variance + kNoise));
  const double of_quantizer = 1 / (1 + error / (kCodedError * step.quantizer_scale * step.quantizer_scale));
  return static_cast<float>(std::max(0.0, of_motion) * of_quantizer);
}

void Lookahead::predict_row(const Step& step, const Band& band, int row, Vectors& vectors, Shares& shares) const {
  for (int column = 0; column < columns_; ++column) {
    const auto i = static_cast<size_t>(row * columns_ + column);
    vectors[i] = search(step, band, column, row, vectors);
    shares[i] = share(step, column, row, vectors[i]);
  }
}

// What the macroblocks are worth goes to those they are predicted from, by the area that each of them lends.
void Lookahead::pass_on(const Vectors& vectors, const Shares& shares, const std::vector<float>& worth,
                        std::vector<float>& before) const {
  for (int row = 0; row < rows_; ++row)
    for (int column = 0; column < columns_; ++column) {
      const auto i = static_cast<size_t>(row * columns_ + column);
      const int x = 32 * column + vectors[i].x_halfpel, y = 32 * row + vectors[i].y_halfpel;
      const float passed = shares[i] * std::min(worth[i], kMostPassed) / 1024;
      const int right = x & 31, below = y & 31;
      for (int corner = 0; corner < 4; ++corner) {
        const int area = ((corner & 1) != 0 ? right : 32 - right) * ((corner & 2) != 0 ? below : 32 - below);
        if (area == 0) continue;
        const int to_column = (x >> 5) + (corner & 1), to_row = (y >> 5) + (corner >> 1);
        before[static_cast<size_t>(to_row * columns_ + to_column)] += passed * static_cast<float>(area);
      }
    }
}

double Lookahead::finer(int picture) const {
  const float* factors = scales(picture);
  if (factors == nullptr) return 1;
  const auto count = static_cast<ptrdiff_t>(columns_) * rows_;
  return static_cast<double>(count) / std::accumulate(factors, factors + count, 0.0);
}

double Lookahead::finer_on_average(int group_length) const {
  if (group_length < 2) return 1;
  double sum = 0;
  for (int picture = 1; picture < group_length; ++picture) sum += finer(picture);
  return sum / (group_length - 1);
}

void Lookahead::look(const Frame420& first, std::span<const Frame420* const> following, double quantizer_scale,
                     std::span<const Band> bands, const MotionKernels& kernels, ThreadPool& pool) {
  const auto count = static_cast<size_t>(columns_) * static_cast<size_t>(rows_);
  vectors_.assign(following.size(), Vectors(count));
  std::vector<Shares> shares(following.size(), Shares(count));
  std::vector<uint8_t> bits_of_difference(kMaxDifference + 1);
  for (int i = 0; i <= kMaxDifference; ++i)
    bits_of_difference[static_cast<size_t>(i)] = static_cast<uint8_t>(motion_bits(std::min(i, 60), 0, 1));
  std::vector<int> band_rows;
  for (const Band& band : bands) band_rows.push_back(band.end_row - band.first_row);
  CoarseMotion coarse(columns_, rows_);
  Frame420 padded[2];
  Step step;
  step.kernels = &kernels;
  step.quantizer_scale = quantizer_scale;
  step.bits_of_difference = bits_of_difference.data();
  step.source = whole_macroblocks(first, padded[0]);
  coarse.start_picture(step.source, kernels, pool);
  coarse.finish_picture();
  for (size_t i = 0; i < following.size(); ++i) {
    step.before = step.source;
    step.source = whole_macroblocks(*following[i], padded[(i + 1) & 1]);
    coarse.start_picture(step.source, kernels, pool);
    step.coarse_vectors = coarse.search(nullptr, kFCode, kernels, pool);
    step.coarse_columns = coarse.block_columns();
    step.last = i > 0 ? &vectors_[i - 1] : nullptr;
    pool.for_each_step(band_rows, [&](int k, int row) {
      const Band& band = bands[static_cast<size_t>(k)];
      predict_row(step, band, band.first_row + row, vectors_[i], shares[i]);
    });
    coarse.finish_picture();
  }
  scales_.assign(following.size() + 1, std::vector<float>(count, 1.0F));
  for (size_t i = following.size(); i-- > 0;) pass_on(vectors_[i], shares[i], scales_[i + 1], scales_[i]);
  pool.for_each(static_cast<int64_t>(scales_.size()), [&](int64_t i) {
    for (float& worth : scales_[static_cast<size_t>(i)])
      worth = static_cast<float>(exact_pow(static_cast<double>(worth), kExponent));
  });
}

}  // namespace pac::mpeg1
