// The elements of an MPEG-1 picture through the range coder: the same code writes and reads (geomcodec/range_coder.h),
// macroblock by macroblock. A block's levels are told from low to high frequency: is there one here, how large, was it
// the last.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <initializer_list>
#include <vector>

#include "base/image.h"
#include "base/kernels/block_kernels.h"
#include "sim/block_contexts.h"
#include "sim/packing_contexts.h"
#include "sim/picture_syntax.h"

namespace pac::sim::packing {

using mpeg1::Macroblock;
using mpeg1::MacroblockKind;

template <class Coder>
class PictureCoder {
 public:
  // prices: of an encoder, null or one a macroblock: what each decision about it costs where it is made, if all before
  // it are as they are.
  PictureCoder(Coder& coder, Learned& learned, PictureSyntax& picture, PlaneView<const uint32_t> surface, int columns,
               int rows, mpeg1::MacroblockPrices* prices = nullptr)
      : coder_(coder),
        learned_(learned),
        picture_(picture),
        surface_(surface),
        columns_(columns),
        rows_(rows),
        prices_(prices) {
    traces_[0].resize(static_cast<size_t>(2 * columns + 1) * 2);
    traces_[1].resize(static_cast<size_t>(columns + 1) * 2);
    traces_[2].resize(static_cast<size_t>(columns + 1) * 2);
  }

  // False where the bytes are no picture.
  bool code() {
    header();
    if constexpr (Coder::kDecodes) picture_.macroblocks.assign(static_cast<size_t>(columns_ * rows_), Macroblock{});
    for (row_ = 0; row_ < rows_; ++row_)
      for (column_ = 0; column_ < columns_; ++column_)
        if (!macroblock() || coder_.failed()) return false;
    return true;
  }

 private:
  uint32_t bit(std::initializer_list<uint32_t> contexts, size_t set, uint32_t value) {
    return learned_.mixer.code(coder_, contexts.begin(), contexts.size(), set, value);
  }
  uint32_t bit(uint32_t context, uint32_t value) { return bit({context}, kSetOther, value); }
  template <size_t n>
  uint32_t bit(const std::array<uint32_t, n>& contexts, size_t set, uint32_t value) {
    return learned_.mixer.code(coder_, contexts.data(), n, set, value);
  }

  // What a bit costs that is not coded here.
  template <size_t n>
  BitMixer::Price price(const std::array<uint32_t, n>& contexts, size_t set) const {
    return learned_.mixer.price(contexts.data(), n, set);
  }
  BitMixer::Price price(uint32_t context) const { return price(std::array{context}, kSetOther); }

  void header() {
    mpeg1::PictureHeader& h = picture_.header;
    h.type = coder_.raw(1, h.type == mpeg1::PictureType::I) != 0 ? mpeg1::PictureType::I : mpeg1::PictureType::P;
    h.temporal_reference = static_cast<int>(coder_.raw(10, static_cast<uint32_t>(h.temporal_reference)));
    h.forward_f_code = static_cast<int>(bit(kLayout.quantizer + 2, h.forward_f_code != 1 ? 1 : 0)) == 0
                           ? 1
                           : static_cast<int>(coder_.raw(3, static_cast<uint32_t>(h.forward_f_code)));
    if (h.forward_f_code == 0) h.forward_f_code = 1;
  }

  Macroblock& at(int column, int row) { return picture_.macroblocks[static_cast<size_t>(row * columns_ + column)]; }
  // 0: outside, else 1 + what `of` says.
  template <class Property>
  uint32_t around(const Property& of) {
    const uint32_t left = column_ > 0 ? 1 + static_cast<uint32_t>(of(at(column_ - 1, row_))) : 0;
    const uint32_t above = row_ > 0 ? 1 + static_cast<uint32_t>(of(at(column_, row_ - 1))) : 0;
    return left * 3 + above;
  }

  static bool skips(const Macroblock& other) { return other.kind == MacroblockKind::skipped; }
  static bool is_intra(const Macroblock& other) { return other.kind == MacroblockKind::intra; }
  static bool moves(const Macroblock& other) { return other.vector != mpeg1::MotionVector{}; }
  uint32_t skipped_context() {
    const uint32_t corner = row_ > 0 && column_ + 1 < columns_ ? 1 + skips(at(column_ + 1, row_ - 1)) : 0;
    return kLayout.skipped + around(skips) * 3 + corner;
  }

  bool macroblock() {
    Macroblock& m = at(column_, row_);
    const bool is_p = picture_.header.type == mpeg1::PictureType::P;
    if (is_p) {
      if (prices_ != nullptr) price_kinds();
      if (bit(skipped_context(), skips(m)) != 0) {
        m.kind = MacroblockKind::skipped;
        predicted_ = {};
        reset_dc();
        for (int block = 0; block < 6; ++block) *trace(block) = {};
        for (int block = 0; prices_ != nullptr && block < 6; ++block) {
          price_pattern(block, pattern_at(block, 0));
          price_block(block);
        }
        return true;
      }
    }
    const bool intra = !is_p || bit(kLayout.kind + around(is_intra), is_intra(m)) != 0;
    m.kind = intra ? MacroblockKind::intra : MacroblockKind::inter;
    if constexpr (Coder::kDecodes) m.first_token = static_cast<uint32_t>(picture_.levels.size());
    next_level_ = m.first_token;
    if (intra) {
      predicted_ = {};
    } else {
      if (!motion(m)) return false;
      reset_dc();
      pattern(m);
    }
    if ((intra || m.pattern != 0) && !quantizer(m)) return false;
    if (m.quantizer == 0) return false;
    for (int block = 0; block < 6; ++block) {
      *trace(block) = {};
      if (intra) dc(m, block);
      if (prices_ != nullptr && intra) price_pattern(block, pattern_at(block, 0));
      if (prices_ != nullptr && (m.pattern & 32 >> block) == 0) price_block(block);
      const bool has_levels = intra ? bit(kLayout.kind + 9, m.counts[block] != 0) != 0 : (m.pattern & 32 >> block) != 0;
      if (has_levels) levels(m, block, intra ? 1 : 0);
      if (!intra || has_levels) learn(block);
    }
    return true;
  }

  void reset_dc() { dc_[0] = dc_[1] = dc_[2] = 128; }

  // A number 0..: Elias' gamma code of value + 1 with learned lengths.
  uint32_t number(uint32_t context, uint32_t value) {
    uint32_t length = 0;
    const auto wanted = static_cast<uint32_t>(std::bit_width(value + 1) - 1);
    while (length < 15 && bit(context + length, wanted > length ? 1 : 0) != 0) ++length;
    const uint32_t low = length > 0 ? coder_.raw(static_cast<int>(length), (value + 1) & ((1u << length) - 1)) : 0;
    return (1u << length | low) - 1;
  }
  int signed_number(uint32_t context, int value) {
    const auto size = static_cast<int>(number(context, static_cast<uint32_t>(std::abs(value))));
    if (size == 0) return 0;
    return coder_.raw(1, value < 0 ? 1 : 0) != 0 ? -size : size;
  }

  bool motion(Macroblock& m) {
    const bool moving = bit(kLayout.moves + around(moves), moves(m)) != 0;
    if (moving) {
      const int x = signed_number(kLayout.motion, m.vector.x_halfpel - predicted_.x_halfpel) + predicted_.x_halfpel;
      const int y =
          signed_number(kLayout.motion + 16, m.vector.y_halfpel - predicted_.y_halfpel) + predicted_.y_halfpel;
      const int limit = 16 << (picture_.header.forward_f_code - 1);
      if (x < -limit || x >= limit || y < -limit || y >= limit) return false;
      m.vector = {static_cast<int16_t>(x), static_cast<int16_t>(y)};
      if (m.vector == mpeg1::MotionVector{}) return false;
    }
    predicted_ = m.vector;
    return true;
  }

  // False where it leaves its range.
  bool quantizer(Macroblock& m) {
    if (quantizer_ == 0) {
      quantizer_ = static_cast<uint8_t>(coder_.raw(5, m.quantizer));
    } else if (bit(quantizer_context(), m.quantizer != quantizer_ ? 1 : 0) != 0) {
      const bool falls = bit(kLayout.quantizer_sign, m.quantizer < quantizer_ ? 1 : 0) != 0;
      const auto wanted = static_cast<uint32_t>(std::abs(m.quantizer - quantizer_) - 1);
      const int step = 1 + static_cast<int>(number(kLayout.quantizer_step, wanted));
      const int changed = falls ? quantizer_ - step : quantizer_ + step;
      if (changed < 1 || changed > 31) return false;
      quantizer_ = static_cast<uint8_t>(changed);
      has_changed_ = true;
    } else {
      has_changed_ = false;
    }
    m.quantizer = quantizer_;
    return true;
  }
  uint32_t quantizer_context() const { return kLayout.quantizer + (has_changed_ ? 1 : 0); }

  // ---- Blocks ------------------------------------------------------------------------------------------------------

  // Traces hold two rows of blocks; column 0 is outside.
  BlockTrace* trace(int block, int dx = 0, int dy = 0) {
    const int plane = plane_of(block), scale = plane == 0 ? 2 : 1;
    const int x = column_ * scale + (plane == 0 ? block & 1 : 0) + dx;
    const int y = row_ * scale + (plane == 0 ? block >> 1 : 0) + dy;
    const auto stride = static_cast<size_t>(columns_ * scale + 1);
    return &traces_[plane][static_cast<size_t>(y & 1) * stride + static_cast<size_t>(x + 1)];
  }
  bool is_first_row(int block) const { return row_ == 0 && (block >= 4 || block < 2); }

  uint32_t surface_at(int block) const {
    const int x = column_ * 16 + (block < 4 ? (block & 1) * 8 + 4 : 8);
    const int y = row_ * 16 + (block < 4 ? (block >> 1) * 8 + 4 : 8);
    return surface_.width > 0 ? *surface_.pixel(x / 4, y / 4) % kSurfaces : 0;
  }
  SurfaceMeans& surface_of(int block) { return learned_.surfaces[surface_at(block) * kPlanes + (block < 4 ? 0 : 1)]; }

  // Contexts of a block's bit of the pattern, of which the bits of the blocks before are known.
  std::array<uint32_t, 4> pattern_at(int block, uint32_t pattern) {
    const uint32_t plane = static_cast<uint32_t>(plane_of(block)), kind = block < 4 ? 0 : plane;
    const uint32_t coded = pattern >> (6 - block);
    const uint32_t left = trace(block, -1)->count, above = is_first_row(block) ? 0 : trace(block, 0, -1)->count;
    // Of this macroblock's own earlier blocks only the pattern is known.
    const auto known = [&](int other) { return (pattern & 32u >> other) != 0 ? 3u : 0u; };
    const uint32_t l = block == 1 || block == 3 ? known(block - 1) : left;
    const uint32_t a = block == 2 || block == 3 ? known(block - 2) : above;
    const uint32_t near = std::min(l, 2u) * 3 + std::min(a, 2u);
    return {kLayout.pattern[0] + kind * 9 + near, kLayout.pattern[1] + static_cast<uint32_t>(block) * 64 + coded,
            kLayout.pattern[2] + kind * 16 + (surface_of(block).coded >> 12),
            kLayout.pattern[3] + (kind * 4 + (l > 0 ? 1 : 0) + (a > 0 ? 2 : 0)) * 14 + level_of(l + a, 13)};
  }

  void pattern(Macroblock& m) {
    uint8_t coded = 0;
    for (int block = 0; block < 6; ++block) {
      const std::array<uint32_t, 4> contexts = pattern_at(block, coded);
      if (prices_ != nullptr) price_pattern(block, contexts);
      if (bit(contexts, kSetPattern, (m.pattern & 32 >> block) != 0 ? 1 : 0) != 0)
        coded = static_cast<uint8_t>(coded | 32 >> block);
    }
    m.pattern = coded;
  }

  void dc(Macroblock& m, int block) {
    const int plane = plane_of(block);
    const int value =
        dc_[plane] + signed_number(kLayout.dc + static_cast<uint32_t>(plane) * 32, m.dc[block] - dc_[plane]);
    dc_[plane] = std::clamp(value, 0, 255);
    m.dc[block] = static_cast<int16_t>(dc_[plane]);
  }

  Expected expected(int block) {
    const BlockTrace& left = *trace(block, -1);
    return expect(left, is_first_row(block) ? nothing_ : *trace(block, 0, -1), block == 5 ? *trace(4) : left,
                  surface_of(block));
  }

  void levels(Macroblock& m, int block, uint32_t first) {
    const Expected e = expected(block);
    BlockTrace& own = *trace(block);
    uint8_t natural[64] = {};
    uint32_t count = 0, run = 0, last_size = 0, k = first;
    for (; k < 64; ++k) {
      Spot s = spot_at(e, block, k, natural);
      s.count = count, s.run = run, s.last_size = last_size;
      int level = 0;
      if constexpr (!Coder::kDecodes) {
        if (count < m.counts[block] && picture_.levels[next_level_].run == run)
          level = picture_.levels[next_level_].level;
        if (prices_ != nullptr) price_spot(e, s, block, static_cast<uint32_t>(std::abs(level)));
      }
      uint32_t is_found = level != 0;
      if (k < 63 || count > 0)  // at the last position of an empty block there must be one
        is_found = bit(found_at(e, s), kSetFound + s.pk, is_found);
      else
        is_found = 1;
      if (is_found == 0) {
        ++run;
        continue;
      }
      const uint32_t size = magnitude(s, static_cast<uint32_t>(std::abs(level)));
      const bool negative = coder_.raw(1, level < 0 ? 1 : 0) != 0;
      if constexpr (Coder::kDecodes)
        picture_.levels.push_back({static_cast<uint8_t>(run),
                                   static_cast<int16_t>(negative ? -static_cast<int>(size) : static_cast<int>(size))});
      else
        ++next_level_;
      ++count;
      run = 0;
      last_size = size;
      natural[kNaturalFromZigzag[k]] = own.size[k] = static_cast<uint8_t>(std::min(size, 255u));
      if (k == 63 || bit(last_at(e, s, count), last_set(s), count == m.counts[block] ? 1 : 0) != 0) break;
    }
    own.count = static_cast<uint8_t>(count);
    if constexpr (Coder::kDecodes) m.counts[block] = static_cast<uint8_t>(count);
    if (prices_ != nullptr) price_zeros(e, block, k + 1, natural, count, last_size);
  }

  // 1..255.
  uint32_t magnitude(const Spot& s, uint32_t size) {
    uint32_t found = 1;
    while (found < 15) {
      if (bit(size_at(s, found), size_set(s, found), size > found ? 1 : 0) == 0) return found;
      ++found;
    }
    return std::min(15 + number(kLayout.motion + 32, size - 15), 255u);
  }

  // ---- Prices ------------------------------------------------------------------------------------------------------

  mpeg1::MacroblockPrices& prices_here() { return prices_[row_ * columns_ + column_]; }
  static uint16_t whole(uint32_t cost) { return static_cast<uint16_t>(std::min(cost, 65535u)); }

  void price_kinds() {
    const BitMixer::Price skipped = price(skipped_context()), kind = price(kLayout.kind + around(is_intra));
    const BitMixer::Price moving = price(kLayout.moves + around(moves)), changes = price(quantizer_context());
    const BitMixer::Price one_step = price(kLayout.quantizer_step);
    constexpr uint32_t kSign = 256;
    prices_here() = {whole(skipped.of[1]),
                     whole(skipped.of[0] + kind.of[0]),
                     whole(skipped.of[0] + kind.of[1]),
                     whole(moving.of[0]),
                     whole(moving.of[1]),
                     whole(changes.of[0]),
                     whole(changes.of[1] + one_step.of[0] + kSign),
                     {}};
  }

  // Of a position where a level of `size` is; 0: none is.
  void price_spot(const Expected& e, const Spot& s, int block, uint32_t size) {
    constexpr uint32_t kSizes = mpeg1::BlockPrices::kSizes, kBit = 256;
    mpeg1::BlockPrices& to = prices_here().blocks[block];
    const BitMixer::Price found = price(found_at(e, s), kSetFound + s.pk);
    to.zero[s.k] = whole(found.of[0]);
    to.level[s.k] = whole(found.of[1] + kBit);
    const BitMixer::Price last = s.k < 63 ? price(last_at(e, s, s.count + 1), last_set(s)) : BitMixer::Price{};
    to.more[s.k] = whole(last.of[0]);
    to.last[s.k] = whole(last.of[1]);
    uint32_t steps = 0;
    BitMixer::Price above{};
    for (uint32_t found_size = 1; found_size <= kSizes; ++found_size) {
      if (found_size <= size + 1) above = price(size_at(s, found_size), size_set(s, found_size));
      to.size[s.k][found_size - 1] = whole(steps + above.of[0]);
      steps += above.of[1];
    }
    to.step[s.k] = whole(above.of[1]);
  }

  // Of the positions from `first` on, as if there were more levels than there are.
  void price_zeros(const Expected& e, int block, uint32_t first, const uint8_t* natural, uint32_t count,
                   uint32_t last_size) {
    for (uint32_t k = first; k < 64; ++k) {
      Spot s = spot_at(e, block, k, natural);
      s.count = count, s.run = k - first, s.last_size = last_size;
      price_spot(e, s, block, 0);
    }
  }

  // Of a block that is left out. Among others that are, too, all of a surface cost nearly the same: those of the last
  // kAgeOfPrices macroblocks are good enough, and most blocks of most pictures are such ones.
  void price_block(int block) {
    constexpr int kAgeOfPrices = 24;
    const uint8_t natural[64] = {};
    if (!is_alone(block)) return price_zeros(expected(block), block, 0, natural, 0, 0);
    if (alone_.empty()) alone_.resize(size_t{3} * kSurfaces);
    Alone& known = alone_[static_cast<size_t>(plane_of(block)) * kSurfaces + surface_at(block)];
    mpeg1::BlockPrices& to = prices_here().blocks[block];
    const int here = row_ * columns_ + column_;
    if (known.made < 0 || here - known.made > kAgeOfPrices) {
      price_zeros(expected(block), block, 0, natural, 0, 0);
      known = {here, to};
    }
    const uint16_t left_out = to.left_out, coded = to.coded;
    to = known.prices;
    to.left_out = left_out;
    to.coded = coded;
  }
  // No levels in the blocks beside.
  bool is_alone(int block) {
    const uint32_t above = is_first_row(block) ? 0 : trace(block, 0, -1)->count;
    return trace(block, -1)->count + above + (block == 5 ? trace(4)->count : 0) == 0;
  }
  void price_pattern(int block, const std::array<uint32_t, 4>& contexts) {
    const BitMixer::Price coded = price(contexts, kSetPattern);
    prices_here().blocks[block].left_out = whole(coded.of[0]);
    prices_here().blocks[block].coded = whole(coded.of[1]);
  }

  void learn(int block) { learn_from(*trace(block), surface_of(block)); }

  Coder& coder_;
  Learned& learned_;
  PictureSyntax& picture_;
  PlaneView<const uint32_t> surface_;
  int columns_, rows_, row_ = 0, column_ = 0;
  mpeg1::MacroblockPrices* prices_;
  size_t next_level_ = 0;
  uint8_t quantizer_ = 0;
  bool has_changed_ = false;
  mpeg1::MotionVector predicted_;
  int dc_[3] = {128, 128, 128};
  std::vector<BlockTrace> traces_[3];
  struct Alone {
    int made = -1;  // at this macroblock
    mpeg1::BlockPrices prices;
  };
  std::vector<Alone> alone_;  // of each plane and surface; empty until it is needed
  BlockTrace nothing_;
};

}  // namespace pac::sim::packing
