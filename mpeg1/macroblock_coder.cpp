#include "mpeg1/macroblock_coder.h"

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <utility>

#include "mpeg1/adapted_matrices.h"
#include "mpeg1/fast_coder.h"
#include "mpeg1/macroblock_place.h"
#include "mpeg1/trellis.h"
#include "mpeg1/vlc_tables.h"

namespace pac::mpeg1 {
namespace {

// Of quantizer_scale, that is worth its bits.
constexpr float kLeastChange = 0.7F, kLeastShare = 0.2F;

// Distance (SATD) in percent of the search's result with its bits, up to which another vector may turn out cheaper.
constexpr uint64_t kWorst = 110;

class RowCoder : private MacroblockPlace {
 public:
  RowCoder(const PictureTask& task, Band& band) : MacroblockPlace(task, band), fast_(task, band) {}

  void code(int row) {
    row_ = row;
    if (row == band_.first_row) band_.tokens.clear();
    last_quantizer_ = row == band_.first_row || row % task_.slice_rows == 0 ? 0 : band_.last_quantizer;
    for (column_ = 0; column_ < task_.columns; ++column_) code_macroblock();
    band_.last_quantizer = last_quantizer_;
  }

 private:
  void code_macroblock() {
    task_.macroblocks[address()] = {};
    if (task_.wanted != nullptr) settle_quantizer();
    if (task_.effort != Effort::fast)
      for (Attempt& attempt : attempts_) start(attempt, quantizer());
    const bool forced = task_.must_be_intra != nullptr && task_.must_be_intra[address()] != 0;
    if (task_.type == PictureType::I || forced) {
      code_intra();
    } else if (task_.effort == Effort::fast) {
      code_fast();
    } else {
      code_by_cost();
    }
  }

  // A change costs five bits and a longer type: that of the last coded macroblock stays while it is near.
  void settle_quantizer() {
    const float wanted = task_.wanted[address()];
    const float near = task_.prices != nullptr ? 0.55F + 0.05F * wanted : std::max(kLeastChange, kLeastShare * wanted);
    const bool stays = last_quantizer_ != 0 && std::abs(wanted - static_cast<float>(last_quantizer_)) < near;
    const int rounded = static_cast<int>(wanted + 0.5F);
    task_.quantizers[address()] = static_cast<uint8_t>(stays ? last_quantizer_ : std::clamp(rounded, 1, 31));
  }

  void start(Attempt& attempt, int attempted_quantizer) const {
    attempt.quantizer = static_cast<uint8_t>(attempted_quantizer);
    attempt.lambda = lambda();
    if (task_.prices != nullptr) attempt.prices = task_.prices + address();
  }

  void code_intra() {
    best_ = 0;
    if (task_.effort == Effort::fast && fast_.code_intra(column_, row_) == FastCoder::Outcome::done) {
      last_quantizer_ = quantizer();
      return;
    }
    start(attempts_[0], quantizer());
    attempt_intra(task_.residual, task_.source, column_, row_, task_.vary_quantizers, attempts_[0]);
    if (task_.vary_quantizers) {
      least_ = intra_cost(attempts_[0]);
      vary_quantizer();
    }
    take(attempts_[best_]);
  }

  SearchResult search() const {
    MotionVector candidates[kMaxCandidates];
    const int n = collect_candidates(candidates);
    SearchOptions options;
    options.max_steps = 16;
    options.hadamard = true;
    options.wide = task_.effort == Effort::best;
    return search_motion(search_input(candidates, n), options);
  }

  void predict(MotionVector vector, Attempt& attempt) const {
    attempt.vector = vector;
    predict_macroblock(motion_, task_.reference, column_, row_, vector, attempt.prediction.planes(), 0, 0);
  }

  void code_fast() {
    const FastCoder::Outcome outcome = fast_.code(column_, row_);
    if (outcome == FastCoder::Outcome::done) return;
    if (outcome == FastCoder::Outcome::intra) return code_intra();
    start(attempts_[0], quantizer());
    predict(fast_.vector(), attempts_[0]);
    attempt_inter(task_.residual, task_.source, column_, row_, false, attempts_[0]);
    take(attempts_[0]);
  }

  // ---- By distortion + lambda * bits -------------------------------------------------------------------------------

  // No coefficient of the attempt's prediction error can reach a level. For luma: a coefficient (times 8) is at most
  // twice its block's sum of differences. For chroma: its square is at most 64 times the block's squared error.
  bool has_no_levels(uint32_t sad, const Attempt& attempt) const {
    const uint32_t weight = task_.residual.non_intra->least_weight[quantizer()];
    if (2 * sad >= weight) return false;
    const MacroblockSamples& p = attempt.prediction;
    const Planes& s = task_.source;
    return 64 * motion_.sse(s.at(1, column_, row_), s.stride[1], p.cb, 8, 8, 8) < weight * weight &&
           64 * motion_.sse(s.at(2, column_, row_), s.stride[2], p.cr, 8, 8, 8) < weight * weight;
  }
  // The prediction as it is.
  void take_without_levels(Attempt& attempt) {
    attempt.kind = MacroblockKind::inter;
    attempt.pattern = 0;
    take(attempt);
  }

  // Bits, / kBit, of coded_block_pattern; of none only where prices are given.
  static int pattern_bits(const Attempt& attempt, unsigned pattern) {
    if (attempt.prices == nullptr) return kPatternCodes[pattern].length * kBit;
    int bits = 0;
    for (unsigned block = 0; block < kBlocks; ++block) {
      const BlockPrices& prices = attempt.prices->blocks[block];
      bits += (pattern & 32u >> block) != 0 ? prices.coded : prices.left_out;
    }
    return bits;
  }
  // Bits, / kBit, of the macroblock's address, type and vector, and of its pattern if it has none.
  int header_bits(const Attempt& attempt, bool is_coded) const {
    const bool moves = attempt.vector != MotionVector{}, skips = !moves && !is_coded && may_skip();
    if (attempt.prices != nullptr) {
      const MacroblockPrices& prices = *attempt.prices;
      if (skips) return prices.skipped;
      const int vector = moves ? prices.moving + vector_bits(attempt.vector) * kBit : prices.still;
      return prices.inter + vector + (is_coded ? 0 : pattern_bits(attempt, 0));
    }
    if (skips) return kBitsSkipped * kBit;
    if (!is_coded) return (kBitsMotion + vector_bits(attempt.vector)) * kBit;
    return (moves ? kBitsMotionCoded + vector_bits(attempt.vector) : kBitsCoded) * kBit;
  }

  // What it takes at least beside the blocks: a code of a pattern has three bits or more. Not where prices are given.
  int64_t least_header(const Attempt& attempt) const {
    return worth(lambda(), std::min(header_bits(attempt, false), header_bits(attempt, true) + 3 * kBit));
  }

  // Leaves out the blocks that the macroblock is cheaper without: a smaller coded_block_pattern may have a longer code.
  void choose_pattern(Attempt& attempt) const {
    constexpr int kMostBits = 6;                                 // by which codes of patterns differ [table B.3]
    const int64_t most = worth(lambda(), kMostBits * kBit) + 1;  // each worth() is rounded
    int64_t lost[64];                                            // distortion less bits' worth, of leaving these out
    unsigned droppable = 0;                                      // blocks that may cost less than the code
    lost[0] = 0;
    for (unsigned left = attempt.pattern; left != 0; left &= left - 1) {
      const unsigned bit = left & (0 - left);
      const BlockCost& block = attempt.costs[5 - std::countr_zero(left)];
      lost[bit] = block.energy - block.distortion - worth(lambda(), block.bits);
      if (attempt.prices != nullptr || lost[bit] <= most) droppable |= bit;
    }
    if (droppable == 0) return;
    int64_t least = worth(lambda(), pattern_bits(attempt, attempt.pattern));
    unsigned chosen = 0;
    for (unsigned dropped = droppable & (0 - droppable); dropped != 0; dropped = (dropped - droppable) & droppable) {
      if (dropped == attempt.pattern) break;
      lost[dropped] = lost[dropped & (dropped - 1)] + lost[dropped & (0 - dropped)];
      const int64_t cost = lost[dropped] + worth(lambda(), pattern_bits(attempt, attempt.pattern ^ dropped));
      if (cost < least) least = cost, chosen = dropped;
    }
    for (unsigned left = chosen; left != 0; left &= left - 1) {
      const BlockCost& block = attempt.costs[5 - std::countr_zero(left)];
      attempt.distortion += block.energy - block.distortion;
      attempt.bits -= block.bits;
    }
    attempt.pattern = static_cast<uint8_t>(attempt.pattern ^ chosen);
  }

  // Of an inter attempt as it stands, or without its coefficients if that is cheaper.
  int64_t settle_inter(Attempt& attempt) const {
    const int64_t without = attempt.energy + worth(lambda(), header_bits(attempt, false));
    if (attempt.pattern == 0) return without;
    choose_pattern(attempt);
    const int bits = attempt.bits + header_bits(attempt, true) + pattern_bits(attempt, attempt.pattern);
    const int64_t with = attempt.distortion + worth(lambda(), bits);
    if (with <= without) return with;
    attempt.pattern = 0;
    return without;
  }

  int64_t intra_cost(const Attempt& attempt) const {
    int bits = kBitsIntra;
    int predictions[3] = {128, 128, 128};
    if (column_ > 0) {
      const Macroblock& left = task_.macroblocks[address() - 1];
      if (left.kind == MacroblockKind::intra)
        for (const int plane : {0, 1, 2}) predictions[plane] = left.dc[plane + 3];
    }
    for (int block = 0; block < kBlocks; ++block) {
      int& prediction = predictions[block < 4 ? 0 : block - 3];
      const int difference = std::abs(attempt.dc[block] - prediction);
      prediction = attempt.dc[block];
      size_t size = 0;
      while (difference >> size != 0) ++size;
      bits += (block < 4 ? kDcSizeLuminance[size].length : kDcSizeChrominance[size].length) + static_cast<int>(size);
    }
    const int kind = attempt.prices != nullptr ? attempt.prices->intra - kBitsIntra * kBit : 0;
    return attempt.distortion + worth(lambda(), attempt.bits + kind + bits * kBit);
  }

  // Tries a vector in the attempt that is not the best one: unless its prediction is so much worse than that of the
  // search's result that what its code saves will not make up for it. A zero vector, which may skip the macroblock, is
  // always tried, and in a replaced reference, which lies where it should, so is every vector.
  void try_vector(MotionVector vector, const SearchResult& found) {
    Attempt& attempt = attempts_[1 - best_];
    start(attempt, quantizer());
    predict(vector, attempt);
    if (!task_.is_replaced && vector != MotionVector{} && vector != found.vector) {
      const uint32_t distance = motion_.satd16(source(), task_.source.stride[0], attempt.prediction.y, 16);
      if (100 * uint64_t{distance} > kWorst * found.cost) return;
    }
    if (attempt_inter(task_.residual, task_.source, column_, row_, true, attempt, least_ - least_header(attempt)))
      keep_if_better(settle_inter(attempt));
  }
  void keep_if_better(int64_t cost) {
    if (cost >= least_) return;
    least_ = cost;
    best_ = 1 - best_;
  }

  // The neighbors of the vector that came out best, by what they really cost.
  void refine_by_cost(const SearchResult& found) {
    const MotionVector center = attempts_[best_].vector;
    const VectorRange reach = range();
    for (int i = 0; i < 9; ++i) {
      const int x = center.x_halfpel + i % 3 - 1, y = center.y_halfpel + i / 3 - 1;
      if (i != 4 && reach.contains(x, y)) try_vector({static_cast<int16_t>(x), static_cast<int16_t>(y)}, found);
    }
  }

  // ---- The quantizer -----------------------------------------------------------------------------------------------

  // Bits, / kBit, of another quantizer than the last one's: its five, and a longer type [table B.2].
  int quantizer_bits(const Attempt& attempt) const {
    const bool is_intra = attempt.kind == MacroblockKind::intra;
    const bool is_coded = is_intra || attempt.pattern != 0;
    if (!is_coded || last_quantizer_ == 0) return 0;
    const bool is_same = attempt.quantizer == last_quantizer_;
    if (attempt.prices != nullptr) return is_same ? attempt.prices->same : attempt.prices->changed;
    if (is_same) return 0;
    if (is_intra) return 6 * kBit;
    return (attempt.vector != MotionVector{} ? 9 : 8) * kBit;
  }

  // The best attempt again with other quantizers, at the same lambda.
  void vary_quantizer() {
    const int nominal = quantizer();
    least_ += worth(lambda(), quantizer_bits(attempts_[best_]));
    const bool last_is_near = 4 * std::abs(last_quantizer_ - nominal) <= std::max(4, nominal);
    const int wanted[3] = {last_quantizer_ != 0 && last_is_near ? last_quantizer_ : nominal, nominal - 1, nominal + 1};
    for (int i = 0; i < 3; ++i) {
      const bool is_new = wanted[i] != nominal && (i == 0 || wanted[i] != wanted[0]);
      const Attempt& best = attempts_[best_];
      if (!is_new || wanted[i] < 1 || wanted[i] > 31 || (best.kind == MacroblockKind::inter && best.pattern == 0))
        continue;
      Attempt& attempt = attempts_[1 - best_];
      start(attempt, wanted[i]);
      int64_t cost = 0;
      if (best.kind == MacroblockKind::intra) {
        if (!attempt_intra(task_.residual, task_.source, column_, row_, true, attempt, least_)) continue;
        cost = intra_cost(attempt);
      } else {
        attempt.vector = best.vector;
        attempt.prediction = best.prediction;
        const int64_t limit = least_ - least_header(attempt);
        if (!attempt_inter(task_.residual, task_.source, column_, row_, true, attempt, limit)) continue;
        cost = settle_inter(attempt);
      }
      keep_if_better(cost + worth(lambda(), quantizer_bits(attempt)));
    }
  }

  void code_by_cost() {
    const uint32_t still_sad = motion_.sad16(source(), task_.source.stride[0], task_.reference.at(0, column_, row_),
                                             task_.reference.stride[0]);
    if (2 * still_sad < task_.residual.non_intra->least_weight[quantizer()]) {
      predict({}, attempts_[0]);
      if (has_no_levels(still_sad, attempts_[0])) return take_without_levels(attempts_[0]);
    }
    const SearchResult found = search();
    least_ = INT64_MAX;
    best_ = 0;
    try_vector(found.vector, found);
    if (found.vector != MotionVector{} && (task_.effort == Effort::best || still_sad < found.sad * 2))
      try_vector({}, found);
    const MotionVector predicted = predicted_vector();
    if (predicted != found.vector && predicted != MotionVector{} &&
        range().contains(predicted.x_halfpel, predicted.y_halfpel))
      try_vector(predicted, found);
    if (task_.effort == Effort::best)
      refine_by_cost(found);
    else if (100 * uint64_t{found.runner_up_cost} <= kWorst * found.cost && found.runner_up != MotionVector{} &&
             found.runner_up != predicted)
      try_vector(found.runner_up, found);
    const int64_t error = attempts_[best_].energy / kDistortionScale;
    if (may_be_intra(static_cast<uint64_t>(error), task_.effort == Effort::best ? 8000 : 2500)) {
      Attempt& attempt = attempts_[1 - best_];
      start(attempt, quantizer());
      if (attempt_intra(task_.residual, task_.source, column_, row_, true, attempt, least_))
        keep_if_better(intra_cost(attempt));
    }
    if (task_.vary_quantizers) vary_quantizer();
    take(attempts_[best_]);
  }

  void take(const Attempt& attempt) {
    Macroblock& macroblock = task_.macroblocks[address()];
    commit(task_.residual, attempt, task_.target, column_, row_, band_.tokens, macroblock);
    if (macroblock.kind == MacroblockKind::intra || macroblock.pattern != 0) last_quantizer_ = macroblock.quantizer;
    if (band_.statistics != nullptr) band_.statistics->add(attempt);
    if (macroblock.kind == MacroblockKind::inter && macroblock.pattern == 0 && macroblock.vector == MotionVector{} &&
        may_skip())
      macroblock.kind = MacroblockKind::skipped;
  }

  FastCoder fast_;
  Attempt attempts_[2];
  int best_ = 0;
  int last_quantizer_ = 0;  // of the last macroblock with coefficients in the slice and the band; 0: none
  int64_t least_ = 0;
};

}  // namespace

void code_row(const PictureTask& task, Band& band, int row) {
  RowCoder(task, band).code(row);
}

}  // namespace pac::mpeg1
