#include "mpeg1/fast_coder.h"

#include <bit>
#include <cstring>

#include "base/kernels/block_kernels.h"
#include "mpeg1/vlc_tables.h"

#define PAC_INLINE inline __attribute__((always_inline))

namespace pac::mpeg1 {
namespace {

// Of luma, from which on a macroblock may be better off without a prediction: 2 a sample. An error worth that,
// 16 a sample squared and more, hardly hides in less.
constexpr uint32_t kLeastIntraSad = 512;
constexpr uint32_t kStillBonusBits = kBitsMotion - kBitsSkipped + 2;  // macroblocks skipped in a row share an address
constexpr int kPatternBits = 1;  // by which one more block makes coded_block_pattern longer, about

// A cache line holds the rows of four macroblocks of luma, of eight of chroma. Those of the next ones are asked for
// while these are worked on, a few at each, as no hardware sees sixteen rows coming and none takes all of them at once.
// Inlined by force: compilers leave out calls of functions that do nothing but this.
PAC_INLINE void prefetch_rows(const Planes& planes, int plane, int column, int row, int first, int count) {
  const ptrdiff_t stride = planes.stride[plane];
  const uint8_t* const at = planes.at(plane, column, row) + first * stride;
  for (int y = 0; y < count; ++y) __builtin_prefetch(at + y * stride);
}
PAC_INLINE void prefetch_next(const Planes& planes, const PictureTask& task, int column, int row) {
  const auto prefetch = [&](int plane, int sharing, int rows) __attribute__((always_inline)) {
    const int turn = column & (sharing - 1), next = column - turn + sharing;
    if (next < task.columns)
      prefetch_rows(planes, plane, next, row, turn * rows, rows);
    else if (row + 1 < task.rows)
      prefetch_rows(planes, plane, 0, row + 1, turn * rows, rows);
  };
  prefetch(0, 4, 4), prefetch(1, 8, 1), prefetch(2, 8, 1);
}

}  // namespace

FastCoder::Outcome FastCoder::code(int column, int row) {
  column_ = column;
  row_ = row;
  prefetch_next(task_.source, task_, column, row);
  prefetch_next(task_.reference, task_, column, row);
  uint32_t quarters[4];
  motion_.sad16_quarters(source(), task_.source.stride[0], task_.reference.at(0, column_, row_),
                         task_.reference.stride[0], quarters);
  if (stays(quarters)) {
    keep_reference();
    return Outcome::done;
  }
  uint32_t sad = 0;
  vector_ = search(quarters[0] + quarters[1] + quarters[2] + quarters[3], sad);
  predict_macroblock(motion_, task_.reference, column_, row_, vector_, task_.target);
  if (sad >= kLeastIntraSad) {
    const Planes& t = task_.target;
    const uint64_t error = motion_.sse(source(), task_.source.stride[0], t.at(0, column_, row_), t.stride[0], 16, 16);
    if (may_be_intra(error, 1000)) return Outcome::intra;
  }
  return code_errors();
}

// The picture before will do as it is. With S the sum of a block's differences the first coefficient (times 8) is at
// most S, the others at most 2 S, which takes an error of a basis function's shape; ordinary ones are far smaller. So
// below 3/4 of the least divisor there is hardly a level, and none that is worth a macroblock's header.
bool FastCoder::stays(const uint32_t (&quarters)[4]) const {
  const uint32_t limit = (3u * task_.residual.non_intra->least_weight[quantizer()] + 3) / 4;
  const uint32_t largest = std::max({quarters[0], quarters[1], quarters[2], quarters[3]});
  if (largest >= limit) return false;
  const Planes& s = task_.source;
  const Planes& r = task_.reference;
  return motion_.sad8(s.at(1, column_, row_), s.stride[1], r.at(1, column_, row_), r.stride[1]) < limit &&
         motion_.sad8(s.at(2, column_, row_), s.stride[2], r.at(2, column_, row_), r.stride[2]) < limit;
}

void FastCoder::keep_reference() {
  vector_ = {};
  coded_.pattern = 0;
  if (task_.shows_reference == nullptr || task_.shows_reference[address()] == 0)
    copy_macroblocks(task_.reference, column_, row_, 1, task_.target);
  describe();
}

MotionVector FastCoder::search(uint32_t still_sad, uint32_t& sad) const {
  MotionVector candidates[kMaxCandidates];
  const int n = collect_candidates(candidates);
  const auto q = static_cast<uint32_t>(quantizer());
  sad = still_sad;
  const bool all_still = std::all_of(candidates, candidates + n, [](MotionVector v) { return v == MotionVector{}; });
  // Not with larger errors: of what moves slowly the next pictures would inherit them, and no level would mend them.
  if (n > 0 && all_still && still_sad < std::max(64u, 8 * q)) return {};
  FastSearchOptions options;
  options.good_sad = 16 * q;
  options.still_sad = still_sad;
  options.still_bonus = kStillBonusBits * q;
  // Where the neighbors agree they are believed, but for some macroblocks that look for themselves.
  options.believes_neighbors = ((column_ ^ row_) & 3) != 0;
  const SearchResult found = search_fast(search_input(candidates, n), options);
  sad = found.sad;
  return found.vector;
}

// The target holds the prediction.
FastCoder::Outcome FastCoder::code_errors() {
  const QuantizerSet& set = *task_.residual.non_intra;
  const uint32_t reaching = motion_.fdct_reaching(
      predicted_samples(task_.source, column_, row_, task_.target, column_, row_), set.least_weight[quantizer()], dct_);
  start_blocks();
  for (int block = 0; block < kBlocks; block += 2) {
    if ((reaching >> block & 3) == 0) continue;
    alignas(64) int16_t levels[128];
    uint64_t nonzero[2];
    task_.residual.kernels->block.quantize(dct_ + 64 * block, set.divide[quantizer()], 2, levels, nonzero);
    for (const int i : {0, 1})
      if (nonzero[i] != 0 && !choose_levels<false>(block + i, levels + 64 * i, nonzero[i])) return Outcome::too_large;
  }
  if (coded_.pattern != 0 && !is_worth_coding()) coded_.pattern = 0;
  if (coded_.pattern != 0) reconstruct();
  describe();
  return Outcome::done;
}

void FastCoder::start_blocks() {
  coded_.n_flat = coded_.n_full = 0;
  coded_.n_tokens = 0;
  coded_.saved = 0;
  coded_.pattern = 0;
  std::memset(coded_.counts, 0, sizeof coded_.counts);
}

FastCoder::Outcome FastCoder::code_intra(int column, int row) {
  alignas(64) static constexpr uint8_t kZeros[16] = {};
  column_ = column;
  row_ = row;
  if (task_.type == PictureType::I) prefetch_next(task_.source, task_, column, row);
  start_blocks();
  PredictedSamples samples{};
  for (const int plane : {0, 1, 2}) {
    samples.source[plane] = task_.source.at(plane, column_, row_);
    samples.source_stride[plane] = task_.source.stride[plane];
    samples.prediction[plane] = kZeros;
  }
  motion_.fdct_macroblock(samples, 1, dct_);
  alignas(64) int16_t levels[64 * kBlocks];
  uint64_t nonzero[kBlocks];
  task_.residual.kernels->block.quantize(dct_, task_.residual.intra->divide[quantizer()], kBlocks, levels, nonzero);
  Macroblock& macroblock = task_.macroblocks[address()];
  for (int block = 0; block < kBlocks; ++block) {
    macroblock.dc[block] = static_cast<int16_t>(std::clamp((dct_[64 * block] + 32) >> 6, 0, 255));
    if (!choose_levels<true>(block, levels + 64 * block, nonzero[block] & ~uint64_t{1})) return Outcome::too_large;
    coded_.coefficients[64 * block] = static_cast<int16_t>(8 * macroblock.dc[block]);
  }
  transform_full(motion_.idct_put);
  macroblock.kind = MacroblockKind::intra;
  macroblock.quantizer = static_cast<uint8_t>(quantizer());
  append_tokens(macroblock);
  return Outcome::done;
}

// Levels of 1 that do not pay are left out, then those after the place where the block had better end, if only at its
// beginning. False: a level has no code. An intra block's first coefficient is none of its business.
template <bool kIsIntra>
bool FastCoder::choose_levels(int block, const int16_t* levels, uint64_t nonzero) {
  const int16_t* const dct = dct_ + 64 * block;
  const QuantizerSet& set = kIsIntra ? *task_.residual.intra : *task_.residual.non_intra;
  const uint16_t* const weight = set.weight[quantizer()];
  const int64_t bit = lambda();
  Token* const tokens = coded_.tokens + coded_.n_tokens;
  int16_t* const coefficients = coded_.coefficients + 64 * coded_.n_full;
  clear_block(coefficients);
  // saved: distortion that the levels take away, less what the bits are worth.
  Token *end = tokens, *best_end = tokens;
  int last = kIsIntra ? 0 : -1, best_last = last;
  int64_t saved = kIsIntra ? 0 : -bit * (kEndOfBlock.length + kPatternBits), best_saved = 0;
  for (uint64_t left = nonzero; left != 0; left &= left - 1) {
    const int position = std::countr_zero(left), natural = kNaturalFromZigzag[position];
    const int level = levels[position], sign = level >> 31, magnitude = (level ^ sign) - sign;
    if (magnitude > kMaxLevel) return false;
    const int value =
        kIsIntra ? reconstruct_intra(magnitude, weight[position]) : reconstruct_non_intra(magnitude, weight[position]);
    if (value == 0) continue;                                                 // decoders disagree about it
    const int gain = 16 * value * (std::abs(int{dct[natural]}) - 4 * value);  // c^2 - (c - 8 value)^2
    const bool is_short = !kIsIntra && position == 0 && magnitude == 1;       // dct_coeff_first
    const Token token = is_short ? first_one_code(level) : coefficient_code(position - last - 1, level);
    const int64_t more = gain - bit * static_cast<int64_t>(token & 31);
    if (magnitude == 1 && more <= 0) continue;
    saved += more;
    *end++ = token;
    coefficients[natural] = static_cast<int16_t>((value ^ sign) - sign);
    last = position;
    if (saved > best_saved) best_saved = saved, best_end = end, best_last = position;
  }
  if (!kIsIntra && best_end == tokens) return true;
  if (best_last != last)
    for (uint64_t left = nonzero & ~uint64_t{1} << best_last; left != 0; left &= left - 1)
      coefficients[kNaturalFromZigzag[std::countr_zero(left)]] = 0;
  *best_end++ = kEndOfBlockCode;
  if (!kIsIntra && best_last == 0) {
    coded_.flat[coded_.n_flat] = coefficients[0];
    coded_.flat_blocks[coded_.n_flat++] = static_cast<uint8_t>(block);
  } else {
    coded_.full_blocks[coded_.n_full++] = static_cast<uint8_t>(block);
  }
  const auto count = static_cast<int>(best_end - tokens);
  coded_.n_tokens += count;
  coded_.counts[block] = static_cast<uint8_t>(count);
  coded_.saved += best_saved;
  coded_.pattern = static_cast<uint8_t>(coded_.pattern | 32 >> block);
  return true;
}

// Against the same vector without coefficients. The blocks have paid for their bits, and for kPatternBits each.
bool FastCoder::is_worth_coding() const {
  const bool moves = vector_ != MotionVector{};
  const int with = kPatternCodes[coded_.pattern].length - kPatternBits * std::popcount(coded_.pattern) +
                   (moves ? kBitsMotionCoded : kBitsCoded);
  const int without = moves || !may_skip() ? kBitsMotion : kBitsSkipped;
  return coded_.saved > lambda() * (with - without);
}

uint8_t* FastCoder::samples_of(int block) const {
  uint8_t* at = task_.target.at(block < 4 ? 0 : block - 3, column_, row_);
  return block < 4 ? at + (block & 1) * 8 + (block >> 1) * 8 * task_.target.stride[0] : at;
}

template <class Transform>
void FastCoder::transform_full(Transform&& transform) const {
  uint8_t* samples[kBlocks];
  ptrdiff_t strides[kBlocks];
  for (size_t i = 0; i < coded_.n_full; ++i) {
    samples[i] = samples_of(coded_.full_blocks[i]);
    strides[i] = stride_of(coded_.full_blocks[i]);
  }
  transform(coded_.coefficients, coded_.n_full, samples, strides);
}

void FastCoder::reconstruct() const {
  for (size_t i = 0; i < coded_.n_flat; ++i)
    motion_.idct_dc_add(coded_.flat[i], samples_of(coded_.flat_blocks[i]), stride_of(coded_.flat_blocks[i]));
  if (coded_.n_full != 0) transform_full(motion_.idct_add);
}

void FastCoder::append_tokens(Macroblock& macroblock) {
  std::memcpy(macroblock.counts, coded_.counts, sizeof coded_.counts);
  macroblock.first_token = static_cast<uint32_t>(band_.tokens.size());
  band_.tokens.insert(band_.tokens.end(), coded_.tokens, coded_.tokens + coded_.n_tokens);
}

void FastCoder::describe() {
  Macroblock& macroblock = task_.macroblocks[address()];
  macroblock.kind = MacroblockKind::inter;
  macroblock.vector = vector_;
  macroblock.pattern = coded_.pattern;
  macroblock.quantizer = static_cast<uint8_t>(quantizer());
  if (coded_.pattern != 0) {
    append_tokens(macroblock);
  } else if (vector_ == MotionVector{} && may_skip()) {
    macroblock.kind = MacroblockKind::skipped;
  }
}

}  // namespace pac::mpeg1
