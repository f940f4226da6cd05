#include "mpeg1/coarse_motion.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace pac::mpeg1 {
namespace {

constexpr int kReduction = 4;
constexpr int kBlock = 8;                  // samples of the small pictures: 2 macroblocks
constexpr uint32_t kStillSad = 96;         // of a block that needs no search: 1.5 a sample
constexpr int kAcross = 20;                // offsets at once
constexpr uint32_t kOffsetCost = 1;        // of a sample's distance from zero, so that flat blocks stay
constexpr int kRowsAtOnce = 16;            // of the small pictures, that a thread makes
constexpr size_t kReadable = 16;           // samples behind the small pictures
constexpr int kHalfPels = 2 * kReduction;  // of a sample of the small pictures

}  // namespace

CoarseMotion::CoarseMotion(int columns, int rows)
    : width_(16 / kReduction * columns),
      height_(16 / kReduction * rows),
      block_columns_((columns + 1) / 2),
      block_rows_((rows + 1) / 2) {}

void CoarseMotion::reduce(const Planes& frame, const MotionKernels& kernels, ThreadPool& pool,
                          std::vector<uint8_t>& small) const {
  small.resize(static_cast<size_t>(width_) * static_cast<size_t>(height_) + kReadable);
  static_assert(kReduction == 4);
  pool.for_each((height_ + kRowsAtOnce - 1) / kRowsAtOnce, [&](int64_t i) {
    const int first = kRowsAtOnce * static_cast<int>(i);
    for (int y = first; y < std::min(first + kRowsAtOnce, height_); ++y)
      kernels.means_4x4(frame.data[0] + kReduction * y * frame.stride[0], frame.stride[0], width_,
                        small.data() + static_cast<size_t>(y) * static_cast<size_t>(width_));
  });
}

void CoarseMotion::start_picture(const Planes& source, const MotionKernels& kernels, ThreadPool& pool) {
  is_searched_ = false;
  has_source_ = width_ >= kBlock && height_ >= kBlock;
  if (has_source_) reduce(source, kernels, pool, source_);
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
  const auto at = [&](int x, int y) { return before_.data() + ptrdiff_t{y0 + y} * width_ + x0 + x; };
  const auto take = [&](int x, int y, uint32_t sad) {
    const uint32_t cost = sad + kOffsetCost * static_cast<uint32_t>(std::abs(x) + std::abs(y));
    if (cost >= least) return;
    least = cost;
    best = {x, y};
  };
  const auto try_offset = [&](int x, int y) {
    if (std::abs(x) > reach || std::abs(y) > reach) return;
    if (x0 + x < 0 || y0 + y < 0 || x0 + x > width_ - kBlock || y0 + y > height_ - kBlock) return;
    take(x, y, kernels.sad8(source, width_, at(x, y), width_));
  };
  try_offset(0, 0);
  const size_t index = static_cast<size_t>(row) * static_cast<size_t>(block_columns_) + static_cast<size_t>(column);
  if (!last_vectors_.empty())
    try_offset(last_vectors_[index].x_halfpel / kHalfPels, last_vectors_[index].y_halfpel / kHalfPels);
  if (least < kStillSad) return best;
  // Each second offset inside the picture.
  const auto first_inside = [reach](int most) { return most >= reach ? -reach : -reach + (reach - most + 1) / 2 * 2; };
  const int first_x = first_inside(x0), last_x = std::min(reach, width_ - kBlock - x0);
  const int last_y = std::min(reach, height_ - kBlock - y0);
  for (int y = first_inside(y0); y <= last_y; y += 2)
    for (int x = first_x; x <= last_x; x += 2 * kAcross) {
      uint32_t sads[kAcross];
      const int n = std::min(kAcross, (last_x - x) / 2 + 1);
      kernels.sad8_across(source, width_, at(x, y), width_, n, sads);
      for (int k = 0; k < n; ++k) take(x + 2 * k, y, sads[k]);
    }
  const Offset center = best;
  for (int i = 0; i < 9; ++i) try_offset(center.x + i % 3 - 1, center.y + i / 3 - 1);
  return best;
}

const MotionVector* CoarseMotion::search(const Planes* replaced, int f_code, const MotionKernels& kernels,
                                         ThreadPool& pool) {
  if (!has_source_ || (!has_before_ && replaced == nullptr)) return nullptr;
  if (is_searched_) return vectors_.data();
  if (replaced != nullptr) {
    reduce(*replaced, kernels, pool, before_);
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
