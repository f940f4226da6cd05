// Motion of 32x32 samples from pictures of a quarter of the size: where a search from neighbors' vectors would end in
// the wrong valley, this one has looked everywhere.
#pragma once

#include <cstdint>
#include <vector>

#include "base/kernels/kernels.h"
#include "base/parallel.h"
#include "mpeg1/mpeg1.h"
#include "mpeg1/predict.h"

namespace pac::mpeg1 {

class CoarseMotion {
 public:
  // Macroblocks of the picture. Below 2 x 2 of them there are no vectors.
  CoarseMotion(int columns, int rows);

  // A new picture: of its frame, luma.
  void start_picture(const Planes& source, const MotionKernels& kernels, ThreadPool& pool);
  // Its vectors relative to the frame before, or to `replaced`, within f_code's range. Once a picture; later calls do
  // nothing. Returns one for each 2 x 2 macroblocks, block_columns() a row, whole samples; null: there are none.
  const MotionVector* search(const Planes* replaced, int f_code, const MotionKernels& kernels, ThreadPool& pool);
  int block_columns() const { return block_columns_; }
  // The picture is the frame before from now on.
  void finish_picture();

 private:
  struct Offset {
    int x = 0, y = 0;  // samples of the small pictures
  };
  void reduce(const Planes& frame, const MotionKernels& kernels, ThreadPool& pool, std::vector<uint8_t>& small) const;
  Offset search_block(int column, int row, int reach, const MotionKernels& kernels) const;

  int width_, height_;  // of the small pictures
  int block_columns_, block_rows_;
  std::vector<uint8_t> source_, before_;  // luma of the small pictures
  bool has_source_ = false, has_before_ = false, is_searched_ = false;
  std::vector<MotionVector> vectors_, last_vectors_;
};

}  // namespace pac::mpeg1
