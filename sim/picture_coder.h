// The elements of an MPEG-1 picture through the range coder: the same code writes and reads (geomcodec/range_coder.h),
// macroblock by macroblock. A block's levels are told from low to high frequency: is there one here, how large, was it
// the last.
#pragma once

#include <algorithm>
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
  PictureCoder(Coder& coder, Learned& learned, PictureSyntax& picture, PlaneView<const uint32_t> surface, int columns,
               int rows)
      : coder_(coder), learned_(learned), picture_(picture), surface_(surface), columns_(columns), rows_(rows) {
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

  bool macroblock() {
    Macroblock& m = at(column_, row_);
    const bool is_p = picture_.header.type == mpeg1::PictureType::P;
    const auto skips = [](const Macroblock& other) { return other.kind == MacroblockKind::skipped; };
    if (is_p) {
      const uint32_t corner = row_ > 0 && column_ + 1 < columns_ ? 1 + skips(at(column_ + 1, row_ - 1)) : 0;
      if (bit(kLayout.skipped + around(skips) * 3 + corner, skips(m)) != 0) {
        m.kind = MacroblockKind::skipped;
        predicted_ = {};
        reset_dc();
        for (int block = 0; block < 6; ++block) *trace(block) = {};
        return true;
      }
    }
    const auto is_intra = [](const Macroblock& other) { return other.kind == MacroblockKind::intra; };
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
    const auto moves = [](const Macroblock& other) { return other.vector != mpeg1::MotionVector{}; };
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

  void pattern(Macroblock& m) {
    uint8_t coded = 0;
    for (int block = 0; block < 6; ++block) {
      const uint32_t plane = static_cast<uint32_t>(plane_of(block)), kind = block < 4 ? 0 : plane;
      const uint32_t left = trace(block, -1)->count, above = is_first_row(block) ? 0 : trace(block, 0, -1)->count;
      // Of this macroblock's own earlier blocks only the pattern is known.
      const auto known = [&](int other) { return (coded & 32 >> other) != 0 ? 3u : 0u; };
      const uint32_t l = block == 1 || block == 3 ? known(block - 1) : left;
      const uint32_t a = block == 2 || block == 3 ? known(block - 2) : above;
      const uint32_t near = std::min(l, 2u) * 3 + std::min(a, 2u);
      const uint32_t value =
          bit({kLayout.pattern[0] + kind * 9 + near,
               kLayout.pattern[1] + static_cast<uint32_t>(block) * 64 + (coded >> (6 - block)),
               kLayout.pattern[2] + kind * 16 + (surface_of(block).coded >> 12),
               kLayout.pattern[3] + (kind * 4 + (l > 0 ? 1 : 0) + (a > 0 ? 2 : 0)) * 14 + level_of(l + a, 13)},
              kSetPattern, (m.pattern & 32 >> block) != 0 ? 1 : 0);
      if (value != 0) coded = static_cast<uint8_t>(coded | 32 >> block);
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

  void levels(Macroblock& m, int block, uint32_t first) {
    const Expected e = expected(block);
    const uint32_t plane = block < 4 ? 0 : 1, kind = static_cast<uint32_t>(plane_of(block));
    BlockTrace& own = *trace(block);
    uint8_t natural[64] = {};
    uint32_t count = 0, run = 0, last_size = 0;
    for (uint32_t k = first; k < 64; ++k) {
      const uint32_t in = level_of(inside(natural, kNaturalFromZigzag[k]), 13), near = level_of(e.near[k], 13);
      const uint32_t mean = level_of(e.surface->mean[k] / 4, 13) + (e.surface->seen > 3 ? 2 : 0);
      const uint32_t pk = plane * 64 + k;
      int level = 0;
      if constexpr (!Coder::kDecodes)
        if (count < m.counts[block] && mpeg1::token_run(picture_.tokens[next_token_]) == static_cast<int>(run))
          level = mpeg1::token_level(picture_.tokens[next_token_]);
      uint32_t is_found = level != 0;
      if (k < 63 || count > 0)  // at the last position of an empty block there must be one
        is_found = bit(
            {kLayout.found[0] + pk * kLevelsSeen + near, kLayout.found[1] + pk * kLevelsSeen + in,
             kLayout.found[2] + ((plane * kLevelsSeen + near) * kLevelsSeen + in) * 8 + std::min(k / 4, 7u),
             kLayout.found[3] + pk * 16 + mean,
             kLayout.found[4] + ((plane * 16 + std::min(k, 30u) / 2) * 8 + std::min(count, 7u)) * 8 + std::min(run, 7u),
             kLayout.found[5] + pk * kLevelsSeen + level_of(e.counts, 13),
             kLayout.found[6] + (kind * 64 + k) * 16 + std::min<uint32_t>(e.other->size[k], 3) * 4 +
                 std::min<uint32_t>(e.above->size[k], 3)},
            kSetFound + pk, is_found);
      else
        is_found = 1;
      if (is_found == 0) {
        ++run;
        continue;
      }
      const uint32_t size =
          magnitude(plane, k, near, in, mean, count, last_size, static_cast<uint32_t>(std::abs(level)));
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
      if (k == 63) break;
      uint32_t rest = 0;
      for (uint32_t i = k + 1; i < 64; ++i) rest += e.near[i];
      const uint32_t is_last = bit(
          {kLayout.last[0] + pk * 8 + std::min(count, 7u), kLayout.last[1] + pk * kLevelsSeen + level_of(e.counts, 13),
           kLayout.last[2] + (plane * 32 + std::min(count, 31u)) * kLevelsSeen + level_of(e.counts, 13),
           kLayout.last[3] + pk * 16 + mean, kLayout.last[4] + pk * kLevelsSeen + level_of(rest / 8, 13)},
          kSetLast + plane * 16 + std::min(k, 15u), count == m.counts[block] ? 1 : 0);
      if (is_last != 0) break;
    }
    own.count = static_cast<uint8_t>(count);
    if constexpr (Coder::kDecodes) m.counts[block] = static_cast<uint8_t>(count);
  }

  // 1..255.
  uint32_t magnitude(uint32_t plane, uint32_t k, uint32_t near, uint32_t in, uint32_t mean, uint32_t count,
                     uint32_t last_size, uint32_t size) {
    uint32_t found = 1;
    while (found < 15) {
      const uint32_t pj = plane * 16 + found;
      if (bit({kLayout.size[0] + pj * kLevelsSeen + near, kLayout.size[1] + pj * kLevelsSeen + in,
               kLayout.size[2] + pj * 64 + k, kLayout.size[3] + pj * 16 + mean,
               kLayout.size[4] + (pj * 16 + std::min(k / 2, 15u)) * 8 + std::min(last_size, 3u) * 2 +
                   (count > 2 ? 1 : 0),
               kLayout.size[5] + (pj * kLevelsSeen + near) * kLevelsSeen + in},
              kSetSize + plane * 4 + std::min(found - 1, 3u), size > found ? 1 : 0) == 0)
        return found;
      ++found;
    }
    return std::min(15 + number(kLayout.motion + 32, size - 15), 255u);
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
  size_t next_token_ = 0;
  uint8_t quantizer_ = 0;
  mpeg1::MotionVector predicted_;
  int dc_[3] = {128, 128, 128};
  std::vector<BlockTrace> traces_[3];
  BlockTrace nothing_;
};

}  // namespace pac::sim::packing
