#include "mpeg1/macroblock_coder.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "base/kernels/block_kernels.h"

namespace pac::mpeg1 {
namespace {

constexpr int kBlocks = 6;
alignas(64) constexpr uint8_t kZeros[16] = {};

// The transform of a macroblock and what quantization made of it.
struct Coefficients {
  alignas(64) int16_t dct[kBlocks * 64];     // natural order, times 8
  alignas(64) int16_t levels[kBlocks * 64];  // zigzag order
  uint64_t nonzero[kBlocks];                 // bit k: level at zigzag position k
};

class BandCoder {
 public:
  BandCoder(const PictureTask& task, Band& band)
      : task_(task), band_(band), motion_(task.kernels->motion), block_(task.kernels->block) {}

  void code() {
    band_.tokens.clear();
    for (row_ = band_.first_row; row_ < band_.end_row; ++row_)
      for (column_ = 0; column_ < task_.columns; ++column_) code_macroblock();
  }

 private:
  int address() const { return row_ * task_.columns + column_; }
  Macroblock& current() const { return task_.macroblocks[address()]; }
  const uint8_t* source(int plane) const { return task_.source.at(plane, column_, row_); }

  void code_macroblock() {
    Macroblock& macroblock = current();
    macroblock = {};
    macroblock.quantizer = task_.quantizers[address()];
    macroblock.first_token = static_cast<uint32_t>(band_.tokens.size());
    const bool forced = task_.must_be_intra != nullptr && task_.must_be_intra[address()] != 0;
    if (task_.type == PictureType::I || forced) return code_intra(macroblock);
    const SearchResult found = search();
    if (prefers_intra(found)) return code_intra(macroblock);
    code_inter(macroblock, found.vector);
  }

  // ---- Decisions ---------------------------------------------------------------------------------------------------

  MotionVector vector_at(int column, int row) const { return task_.macroblocks[row * task_.columns + column].vector; }

  // What the stream predicts the vector from, as far as the band knows.
  MotionVector predicted_vector() const { return column_ > 0 ? vector_at(column_ - 1, row_) : MotionVector{}; }

  SearchResult search() const {
    MotionVector candidates[24];
    int n = 0;
    const auto add = [&](MotionVector v) {
      if (n < 24) candidates[n++] = v;
    };
    for (int i = 0; i < std::min(task_.candidates_per_macroblock, 8); ++i)
      add(task_.candidates[address() * task_.candidates_per_macroblock + i]);
    if (column_ > 0) add(vector_at(column_ - 1, row_));
    if (row_ > band_.first_row) {
      add(vector_at(column_, row_ - 1));
      if (column_ + 1 < task_.columns) add(vector_at(column_ + 1, row_ - 1));
    }
    if (task_.last_vectors != nullptr) {
      const MotionVector* last = task_.last_vectors + address();
      add(last[0]);
      if (column_ + 1 < task_.columns) add(last[1]);
      if (row_ + 1 < task_.rows) add(last[task_.columns]);
    }
    SearchInput input;
    input.kernels = &motion_;
    input.source = source(0);
    input.source_stride = task_.source.stride[0];
    input.reference = task_.reference;
    input.column = column_;
    input.row = row_;
    input.range = vector_range(task_.reference, column_, row_, task_.f_code);
    input.predicted = predicted_vector();
    input.candidates = candidates;
    input.n_candidates = n;
    input.lambda_q4 = 16u * current().quantizer;
    input.bits_of_difference = task_.bits_of_difference;
    SearchOptions options;
    return search_motion(input, options);
  }

  // The prediction error is larger than the macroblock's own variation.
  bool prefers_intra(const SearchResult& found) const {
    if (found.sad < 1024) return false;
    uint32_t sum = 0, sum_of_squares = 0;
    motion_.moments16(source(0), task_.source.stride[0], &sum, &sum_of_squares);
    const uint32_t variation = sum_of_squares - static_cast<uint32_t>(static_cast<uint64_t>(sum) * sum / 256);
    // The squares of the error are at least sad^2 / 256.
    const uint64_t error = static_cast<uint64_t>(found.sad) * found.sad / 256 * 3 / 2;
    return error > variation + 256 * 16;
  }

  // ---- Coding ------------------------------------------------------------------------------------------------------

  void transform(const Planes& prediction, int column, int row, Coefficients& c) const {
    for (int half = 0; half < 2; ++half)
      motion_.fdct_residual(source(0) + 8 * half * task_.source.stride[0], task_.source.stride[0],
                            prediction.at(0, column, row) + 8 * half * prediction.stride[0], prediction.stride[0], 2,
                            c.dct + 128 * half);
    for (const int plane : {1, 2})
      motion_.fdct_residual(source(plane), task_.source.stride[plane], prediction.at(plane, column, row),
                            prediction.stride[plane], 1, c.dct + 64 * (3 + plane));
  }
  void transform_intra(Coefficients& c) const {
    for (int half = 0; half < 2; ++half)
      motion_.fdct_residual(source(0) + 8 * half * task_.source.stride[0], task_.source.stride[0], kZeros, 0, 2,
                            c.dct + 128 * half);
    for (const int plane : {1, 2})
      motion_.fdct_residual(source(plane), task_.source.stride[plane], kZeros, 0, 1, c.dct + 64 * (3 + plane));
  }

  static int largest_level(const Coefficients& c, int first_position) {
    int largest = 0;
    for (int block = 0; block < kBlocks; ++block) {
      uint64_t mask = c.nonzero[block] >> first_position << first_position;
      for (; mask != 0; mask &= mask - 1) {
        const int level = c.levels[64 * block + std::countr_zero(mask)];
        largest = std::max(largest, level < 0 ? -level : level);
      }
    }
    return largest;
  }

  // Quantizes at the macroblock's quantizer, or the next one at which every level has a code.
  void quantize(const QuantizerSet& set, int first_position, Macroblock& macroblock, Coefficients& c) const {
    for (;; ++macroblock.quantizer) {
      block_.quantize(c.dct, set.divide[macroblock.quantizer], kBlocks, c.levels, c.nonzero);
      if (macroblock.quantizer == 31 || largest_level(c, first_position) <= kMaxLevel) break;
    }
    for (int16_t& level : c.levels) level = static_cast<int16_t>(std::clamp<int>(level, -kMaxLevel, kMaxLevel));
  }

  int append_tokens(const int16_t* levels, uint64_t mask, int last_position) {
    int count = 0;
    for (; mask != 0; mask &= mask - 1, ++count) {
      const int position = std::countr_zero(mask);
      band_.tokens.push_back(make_token(position - last_position - 1, levels[position]));
      last_position = position;
    }
    return count;
  }

  void place(int block, uint8_t*& samples, ptrdiff_t& stride) const {
    const int plane = block < 4 ? 0 : block - 3;
    stride = task_.target.stride[plane];
    samples = task_.target.at(plane, column_, row_);
    if (block < 4) samples += (block & 1) * 8 + (block >> 1) * 8 * stride;
  }

  template <bool kIsIntra>
  static void dequantize(const int16_t* levels, uint64_t mask, const uint16_t* weight, int16_t* coefficients) {
    std::memset(coefficients, 0, 128);
    for (; mask != 0; mask &= mask - 1) {
      const int position = std::countr_zero(mask);
      const int level = levels[position], magnitude = level < 0 ? -level : level;
      const int value = kIsIntra ? reconstruct_intra(magnitude, weight[position])
                                 : reconstruct_non_intra(magnitude, weight[position]);
      coefficients[kNaturalFromZigzag[position]] = static_cast<int16_t>(level < 0 ? -value : value);
    }
  }

  void code_intra(Macroblock& macroblock) {
    Coefficients c;
    transform_intra(c);
    macroblock.kind = MacroblockKind::intra;
    quantize(*task_.intra, 1, macroblock, c);
    alignas(64) int16_t coefficients[kBlocks * 64];
    uint8_t* samples[kBlocks];
    ptrdiff_t strides[kBlocks];
    for (int block = 0; block < kBlocks; ++block) {
      const int dc = std::clamp((c.dct[64 * block] + 32) >> 6, 0, 255);
      macroblock.dc[block] = static_cast<int16_t>(dc);
      const uint64_t mask = c.nonzero[block] & ~uint64_t{1};
      macroblock.counts[block] = static_cast<uint8_t>(append_tokens(c.levels + 64 * block, mask, 0));
      dequantize<true>(c.levels + 64 * block, mask, task_.intra->weight[macroblock.quantizer],
                       coefficients + 64 * block);
      coefficients[64 * block] = static_cast<int16_t>(8 * dc);
      place(block, samples[block], strides[block]);
    }
    motion_.idct_put(coefficients, kBlocks, samples, strides);
  }

  // The first and the last macroblock of a slice are never skipped [2.4.4.4].
  bool may_skip() const {
    const bool is_first = column_ == 0 && row_ % task_.slice_rows == 0;
    const bool is_last = column_ == task_.columns - 1 && ((row_ + 1) % task_.slice_rows == 0 || row_ + 1 == task_.rows);
    return !is_first && !is_last;
  }

  void code_inter(Macroblock& macroblock, MotionVector vector) {
    predict_macroblock(motion_, task_.reference, column_, row_, vector, task_.target);
    Coefficients c;
    transform(task_.target, column_, row_, c);
    quantize(*task_.non_intra, 0, macroblock, c);
    macroblock.kind = MacroblockKind::inter;
    macroblock.vector = vector;
    alignas(64) int16_t coefficients[kBlocks * 64];
    uint8_t* samples[kBlocks];
    ptrdiff_t strides[kBlocks];
    size_t n_coded = 0;
    for (int block = 0; block < kBlocks; ++block) {
      const uint64_t mask = c.nonzero[block];
      if (mask == 0) continue;
      macroblock.pattern = static_cast<uint8_t>(macroblock.pattern | 32 >> block);
      macroblock.counts[block] = static_cast<uint8_t>(append_tokens(c.levels + 64 * block, mask, -1));
      dequantize<false>(c.levels + 64 * block, mask, task_.non_intra->weight[macroblock.quantizer],
                        coefficients + 64 * n_coded);
      place(block, samples[n_coded], strides[n_coded]);
      ++n_coded;
    }
    if (n_coded != 0) motion_.idct_add(coefficients, n_coded, samples, strides);
    if (macroblock.pattern == 0 && vector == MotionVector{} && may_skip()) macroblock.kind = MacroblockKind::skipped;
  }

  const PictureTask& task_;
  Band& band_;
  const MotionKernels& motion_;
  const BlockKernels& block_;
  int row_ = 0, column_ = 0;
};

}  // namespace

void code_band(const PictureTask& task, Band& band) {
  BandCoder(task, band).code();
}

}  // namespace pac::mpeg1
