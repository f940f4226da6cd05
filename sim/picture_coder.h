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
    if constexpr (Coder::kDecodes) m.first_token = static_cast<uint32_t>(picture_.tokens.size());
    next_token_ = m.first_token;
    if (intra) {
      predicted_ = {};
    } else {
      if (!motion(m)) return false;
      reset_dc();
      pattern(m);
    }
    if (intra || m.pattern != 0) quantizer(m);
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

  void quantizer(Macroblock& m) {
    if (bit(kLayout.quantizer + (quantizer_ == 0 ? 1 : 0), m.quantizer != quantizer_ ? 1 : 0) != 0)
      quantizer_ = static_cast<uint8_t>(coder_.raw(5, m.quantizer));
    m.quantizer = quantizer_;
  }

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

  SurfaceMeans& surface_of(int block) {
    const int x = column_ * 16 + (block < 4 ? (block & 1) * 8 + 4 : 8);
    const int y = row_ * 16 + (block < 4 ? (block >> 1) * 8 + 4 : 8);
    uint32_t surface = 0;
    if (surface_.width > 0)
      surface = surface_.row(std::min(y, surface_.height - 1))[std::min(x, surface_.width - 1)] % kSurfaces;
    return learned_.surfaces[surface * kPlanes + (block < 4 ? 0 : 1)];
  }

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

  // What is known of a block's levels before they are coded.
  struct Expected {
    const BlockTrace* left;
    const BlockTrace* above;
    const BlockTrace* other;  // of Cr: Cb's
    const SurfaceMeans* surface;
    uint32_t near[64];    // of left and above, by zigzag position
    uint32_t rest[64];    // near of all positions behind
    uint32_t counts = 0;  // theirs
  };

  Expected expected(int block) {
    Expected e;
    e.left = trace(block, -1);
    e.above = is_first_row(block) ? &nothing_ : trace(block, 0, -1);
    e.other = block == 5 ? trace(4) : e.left;
    e.surface = &surface_of(block);
    e.counts = e.left->count + e.above->count;
    uint32_t sum[64];
    for (size_t k = 0; k < 64; ++k) sum[kNaturalFromZigzag[k]] = e.left->size[k] + e.above->size[k];
    for (size_t k = 0; k < 64; ++k) {
      const size_t n = kNaturalFromZigzag[k], u = n % 8, v = n / 8;
      e.near[k] = 2 * sum[n] + (u > 0 ? sum[n - 1] : 0) + (u < 7 ? sum[n + 1] : 0) + (v > 0 ? sum[n - 8] : 0) +
                  (v < 7 ? sum[n + 8] : 0);
    }
    uint32_t rest = 0;
    for (size_t k = 64; k-- > 0; rest += e.near[k]) e.rest[k] = rest;
    return e;
  }

  // |levels| around a position in this block, those already coded.
  static uint32_t inside(const uint8_t* natural, size_t n) {
    const size_t u = n % 8, v = n / 8;
    uint32_t sum = 0;
    if (u > 0) sum += 2u * natural[n - 1];
    if (v > 0) sum += 2u * natural[n - 8];
    if (u > 0 && v > 0) sum += natural[n - 9];
    if (u > 1) sum += natural[n - 2];
    if (v > 1) sum += natural[n - 16];
    if (u > 0 && v < 7) sum += natural[n + 7];
    if (u < 7 && v > 0) sum += natural[n - 7];
    return sum;
  }

  // A position of a block, and what is known there.
  struct Spot {
    uint32_t plane, kind, k, pk;
    uint32_t near, in, mean;
    uint32_t count = 0, run = 0, last_size = 0;  // of the levels before
  };

  Spot spot_at(const Expected& e, int block, uint32_t k, const uint8_t* natural) const {
    Spot s;
    s.plane = block < 4 ? 0 : 1;
    s.kind = static_cast<uint32_t>(plane_of(block));
    s.k = k;
    s.pk = s.plane * 64 + k;
    s.near = level_of(e.near[k], 13);
    s.in = level_of(inside(natural, kNaturalFromZigzag[k]), 13);
    s.mean = level_of(e.surface->mean[k] / 4, 13) + (e.surface->seen > 3 ? 2 : 0);
    return s;
  }

  // Contexts: of whether there is a level here; whether it is the last, `count` with it; whether it is above `found`.
  std::array<uint32_t, 7> found_at(const Expected& e, const Spot& s) const {
    return {kLayout.found[0] + s.pk * kLevelsSeen + s.near,
            kLayout.found[1] + s.pk * kLevelsSeen + s.in,
            kLayout.found[2] + ((s.plane * kLevelsSeen + s.near) * kLevelsSeen + s.in) * 8 + std::min(s.k / 4, 7u),
            kLayout.found[3] + s.pk * 16 + s.mean,
            kLayout.found[4] + ((s.plane * 16 + std::min(s.k, 30u) / 2) * 8 + std::min(s.count, 7u)) * 8 +
                std::min(s.run, 7u),
            kLayout.found[5] + s.pk * kLevelsSeen + level_of(e.counts, 13),
            kLayout.found[6] + (s.kind * 64 + s.k) * 16 + std::min<uint32_t>(e.other->size[s.k], 3) * 4 +
                std::min<uint32_t>(e.above->size[s.k], 3)};
  }
  std::array<uint32_t, 5> last_at(const Expected& e, const Spot& s, uint32_t count) const {
    const uint32_t around = level_of(e.counts, 13);
    return {kLayout.last[0] + s.pk * 8 + std::min(count, 7u), kLayout.last[1] + s.pk * kLevelsSeen + around,
            kLayout.last[2] + (s.plane * 32 + std::min(count, 31u)) * kLevelsSeen + around,
            kLayout.last[3] + s.pk * 16 + s.mean, kLayout.last[4] + s.pk * kLevelsSeen + level_of(e.rest[s.k] / 8, 13)};
  }
  std::array<uint32_t, 6> size_at(const Spot& s, uint32_t found) const {
    const uint32_t pj = s.plane * 16 + found;
    return {kLayout.size[0] + pj * kLevelsSeen + s.near,
            kLayout.size[1] + pj * kLevelsSeen + s.in,
            kLayout.size[2] + pj * 64 + s.k,
            kLayout.size[3] + pj * 16 + s.mean,
            kLayout.size[4] + (pj * 16 + std::min(s.k / 2, 15u)) * 8 + std::min(s.last_size, 3u) * 2 +
                (s.count > 2 ? 1 : 0),
            kLayout.size[5] + (pj * kLevelsSeen + s.near) * kLevelsSeen + s.in};
  }
  static size_t last_set(const Spot& s) { return kSetLast + s.plane * 16 + std::min(s.k, 15u); }
  static size_t size_set(const Spot& s, uint32_t found) { return kSetSize + s.plane * 4 + std::min(found - 1, 3u); }

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
        if (count < m.counts[block] && mpeg1::token_run(picture_.tokens[next_token_]) == static_cast<int>(run))
          level = mpeg1::token_level(picture_.tokens[next_token_]);
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
        picture_.tokens.push_back(
            mpeg1::make_token(static_cast<int>(run), negative ? -static_cast<int>(size) : static_cast<int>(size)));
      else
        ++next_token_;
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
    const BitMixer::Price moving = price(kLayout.moves + around(moves));
    prices_here() = {whole(skipped.of[1]),
                     whole(skipped.of[0] + kind.of[0]),
                     whole(skipped.of[0] + kind.of[1]),
                     whole(moving.of[0]),
                     whole(moving.of[1]),
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

  // Of a block that is left out.
  void price_block(int block) {
    const uint8_t natural[64] = {};
    price_zeros(expected(block), block, 0, natural, 0, 0);
  }
  void price_pattern(int block, const std::array<uint32_t, 4>& contexts) {
    const BitMixer::Price coded = price(contexts, kSetPattern);
    prices_here().blocks[block].left_out = whole(coded.of[0]);
    prices_here().blocks[block].coded = whole(coded.of[1]);
  }

  void learn(int block) {
    SurfaceMeans& s = surface_of(block);
    const BlockTrace& own = *trace(block);
    const int step = 65536 / (s.seen + 2);
    s.coded = static_cast<uint16_t>(s.coded + (((own.count > 0 ? 65535 : 0) - s.coded) * int64_t{step} >> 16));
    for (size_t k = 0; k < 64; ++k)
      s.mean[k] =
          static_cast<uint16_t>(s.mean[k] + ((64 * std::min<int>(own.size[k], 200) - s.mean[k]) * int64_t{step} >> 16));
    if (s.seen < 40) ++s.seen;
  }

  Coder& coder_;
  Learned& learned_;
  PictureSyntax& picture_;
  PlaneView<const uint32_t> surface_;
  int columns_, rows_, row_ = 0, column_ = 0;
  mpeg1::MacroblockPrices* prices_;
  size_t next_token_ = 0;
  uint8_t quantizer_ = 0;
  mpeg1::MotionVector predicted_;
  int dc_[3] = {128, 128, 128};
  std::vector<BlockTrace> traces_[3];
  BlockTrace nothing_;
};

}  // namespace pac::sim::packing
