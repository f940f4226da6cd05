#include "mpeg1/coarse_motion.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace pac::mpeg1 {
namespace {

constexpr int kReduction = 4;
constexpr int kBlock = 8;                  // samples of the small pictures: 2 macroblocks
constexpr uint32_t kStillSad = 96;         // of a block that needs no search: 1.5 a sample
constexpr uint32_t kOffsetCost = 1;        // of a sample's distance from zero, so that flat blocks stay
constexpr int kRowsAtOnce = 16;            // of the small pictures, that a thread makes
constexpr int kHalfPels = 2 * kReduction;  // of a sample of the small pictures

}  // namespace

CoarseMotion::CoarseMotion(int columns, int rows)
    : width_(16 / kReduction * columns),
      height_(16 / kReduction * rows),
      block_columns_((columns + 1) / 2),
      block_rows_((rows + 1) / 2) {}

// Means of 4 x 4 samples.
void CoarseMotion::reduce(const Planes& frame, ThreadPool& pool, std::vector<uint8_t>& small) const {
  small.resize(static_cast<size_t>(width_) * static_cast<size_t>(height_));
  pool.for_each((height_ + kRowsAtOnce - 1) / kRowsAtOnce, [&](int64_t i) {
    const int first = kRowsAtOnce * static_cast<int>(i);
    reduce_rows(frame, first, std::min(first + kRowsAtOnce, height_), small);
  });
}

void CoarseMotion::reduce_rows(const Planes& frame, int first, int end, std::vector<uint8_t>& small) const {
  std::vector<uint16_t> sums(static_cast<size_t>(kReduction * width_));
  for (int y = first; y < end; ++y) {
    const uint8_t* row = frame.data[0] + kReduction * y * frame.stride[0];
    const ptrdiff_t stride = frame.stride[0];
    for (size_t x = 0; x < sums.size(); ++x) {
      const uint8_t* p = row + x;
      sums[x] = static_cast<uint16_t>(p[0] + p[stride] + p[2 * stride] + p[3 * stride]);
    }
    uint8_t* out = small.data() + static_cast<size_t>(y) * static_cast<size_t>(width_);
    for (size_t x = 0; x < static_cast<size_t>(width_); ++x)
      out[x] = static_cast<uint8_t>((sums[4 * x] + sums[4 * x + 1] + sums[4 * x + 2] + sums[4 * x + 3] + 8) >> 4);
  }
}

void CoarseMotion::start_picture(const Planes& source, ThreadPool& pool) {
  is_searched_ = false;
  has_source_ = width_ >= kBlock && height_ >= kBlock;
  if (has_source_) reduce(source, pool, source_);
}

void CoarseMotion::finish_picture() {
  if (!has_source_) return;
  std::swap(source_, before_);
  has_before_ = true;
  has_source_ = false;
  if (is_searched_)
    std::swap(vectors_, last_vectors_);
  else
    last_vectors_.clear();
}

CoarseMotion::Offset CoarseMotion::search_block(int column, int row, int reach, const MotionKernels& kernels) const {
  const int x0 = std::min(kBlock * column, width_ - kBlock), y0 = std::min(kBlock * row, height_ - kBlock);
  const uint8_t* source = source_.data() + ptrdiff_t{y0} * width_ + x0;
  Offset best;
  uint32_t least = ~uint32_t{0};
  const auto try_offset = [&](int x, int y) {
    if (std::abs(x) > reach || std::abs(y) > reach) return;
    if (x0 + x < 0 || y0 + y < 0 || x0 + x > width_ - kBlock || y0 + y > height_ - kBlock) return;
    const uint8_t* reference = before_.data() + ptrdiff_t{y0 + y} * width_ + x0 + x;
    const uint32_t sad = kernels.sad8(source, width_, reference, width_);
    const uint32_t cost = sad + kOffsetCost * static_cast<uint32_t>(std::abs(x) + std::abs(y));
    if (cost >= least) return;
    least = cost;
    best = {x, y};
  };
  try_offset(0, 0);
  const size_t index = static_cast<size_t>(row) * static_cast<size_t>(block_columns_) + static_cast<size_t>(column);
  if (!last_vectors_.empty())
    try_offset(last_vectors_[index].x_halfpel / kHalfPels, last_vectors_[index].y_halfpel / kHalfPels);
  if (least < kStillSad) return best;
  for (int y = -reach; y <= reach; y += 2)
    for (int x = -reach; x <= reach; x += 2) try_offset(x, y);
  const Offset center = best;
  for (int i = 0; i < 9; ++i) try_offset(center.x + i % 3 - 1, center.y + i / 3 - 1);
  return best;
}

const MotionVector* CoarseMotion::search(const Planes* replaced, int f_code, const MotionKernels& kernels,
                                         ThreadPool& pool) {
  if (!has_source_ || (!has_before_ && replaced == nullptr)) return nullptr;
  if (is_searched_) return vectors_.data();
  if (replaced != nullptr) {
    reduce(*replaced, pool, before_);
    has_before_ = true;
  }
  vectors_.resize(static_cast<size_t>(block_columns_) * static_cast<size_t>(block_rows_));
  const int reach = (16 << (f_code - 1)) / kHalfPels;
  pool.for_each(block_rows_, [&](int64_t row) {
    for (int column = 0; column < block_columns_; ++column) {
      const Offset offset = search_block(column, static_cast<int>(row), reach, kernels);
      vectors_[static_cast<size_t>(row) * static_cast<size_t>(block_columns_) + static_cast<size_t>(column)] = {
          static_cast<int16_t>(kHalfPels * offset.x), static_cast<int16_t>(kHalfPels * offset.y)};
    }
  });
  is_searched_ = true;
  return vectors_.data();
}

}  // namespace pac::mpeg1
