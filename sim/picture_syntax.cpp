#include "sim/picture_syntax.h"

#include <cstdlib>

#include "mpeg1/bit_reader.h"
#include "mpeg1/headers.h"
#include "mpeg1/motion_vector.h"
#include "mpeg1/slice_writer.h"
#include "mpeg1/vlc_tables.h"

namespace pac::sim {

namespace {

using mpeg1::Macroblock;
using mpeg1::MacroblockKind;

constexpr size_t kStartCodeBytes = 4;
constexpr int kBlocks = 6;  // of a macroblock

// The one slice of a picture [11172-2 2.4.2.6 to 2.4.2.8]. What a decoder would refuse is refused.
class SyntaxReader {
 public:
  SyntaxReader(std::span<const uint8_t> bytes, int count, PictureSyntax& picture)
      : bits_(bytes), count_(count), picture_(picture) {}

  bool read() {
    picture_.macroblocks.assign(static_cast<size_t>(count_), Macroblock{});
    picture_.levels.clear();
    quantizer_ = static_cast<int>(bits_.read(5));
    if (quantizer_ == 0 || bits_.read(1) != 0) return false;
    do {
      if (!read_macroblock() || bits_.overrun()) return false;
    } while (!bits_.only_zeros_left());
    return address_ == count_ - 1;
  }

 private:
  void reset_dc() { dc_[0] = dc_[1] = dc_[2] = 128; }

  bool read_address() {
    const int before = address_;
    for (;;) {
      bits_.refill();
      const mpeg1::Symbol symbol = mpeg1::kReading.address_increment[bits_.peek(11)];
      if (symbol.length == 0) return false;
      bits_.skip(symbol.length);
      if (symbol.value == mpeg1::kAddressStuffing) continue;
      address_ += symbol.value == mpeg1::kAddressEscape ? 33 : symbol.value;
      if (address_ >= count_) return false;
      if (symbol.value != mpeg1::kAddressEscape) break;
    }
    if (address_ == before + 1) return true;
    vector_ = {};
    reset_dc();
    return picture_.header.type == mpeg1::PictureType::P && before >= 0;
  }

  bool read_component(int16_t& component) {
    bits_.refill();
    const mpeg1::Symbol symbol = mpeg1::kReading.motion[bits_.peek(11)];
    if (symbol.length == 0) return false;
    bits_.skip(symbol.length);
    const int r_size = picture_.header.forward_f_code - 1;
    mpeg1::MotionCode motion{symbol.value - 16, 0};
    if (r_size != 0 && motion.code != 0) {
      motion.r = static_cast<int>(bits_.peek(r_size));
      bits_.skip(r_size);
    }
    component = static_cast<int16_t>(mpeg1::vector_from(motion, component, r_size));
    return true;
  }

  bool read_dc(int block, Macroblock& macroblock) {
    bits_.refill();
    const mpeg1::Symbol symbol =
        block < 4 ? mpeg1::kReading.dc_luminance[bits_.peek(7)] : mpeg1::kReading.dc_chrominance[bits_.peek(8)];
    if (symbol.length == 0) return false;
    bits_.skip(symbol.length);
    int& prediction = dc_[block < 4 ? 0 : block - 3];
    if (symbol.value != 0) {
      int differential = static_cast<int>(bits_.peek(symbol.value));
      bits_.skip(symbol.value);
      if (differential >> (symbol.value - 1) == 0) differential += 1 - (1 << symbol.value);
      prediction += differential;
    }
    macroblock.dc[block] = static_cast<int16_t>(prediction);
    return prediction >= 0 && prediction <= 255;
  }

  // The level of an escape; 0 where it is forbidden.
  int read_escape_level() {
    const int first = static_cast<int8_t>(bits_.read(8));
    if ((first & 127) != 0) return first;
    const auto second = static_cast<int>(bits_.read(8));
    if (first == 0) return second >= 128 ? second : 0;
    return second <= 128 ? second == 0 ? 0 : second - 256 : 0;
  }

  // Coefficients after zigzag `position`.
  bool read_block(int position, bool first_is_special, uint8_t& count) {
    const size_t first = picture_.levels.size();
    bits_.refill();
    if (first_is_special && bits_.peek(1) != 0) {
      picture_.levels.push_back({0, static_cast<int16_t>(bits_.peek(2) == 2 ? 1 : -1)});
      bits_.skip(2);
      position = 0;
    }
    for (;;) {
      bits_.refill();
      const mpeg1::CoefficientSymbol* symbol = &mpeg1::kReading.coefficient_short[bits_.peek(mpeg1::kShortBits)];
      if (symbol->advance == mpeg1::kAdvanceNone)
        symbol =
            &mpeg1::kReading
                 .coefficient_long[bits_.peek(mpeg1::kLongBits) & ((1 << (mpeg1::kLongBits - mpeg1::kLongPrefix)) - 1)];
      bits_.skip(symbol->length);
      if (symbol->advance == mpeg1::kAdvanceEndOfBlock) break;
      if (symbol->advance == mpeg1::kAdvanceNone) return false;
      int run = symbol->advance - 1, level = symbol->level;
      if (symbol->advance == mpeg1::kAdvanceEscape) {
        run = static_cast<int>(bits_.read(6));
        level = read_escape_level();
      }
      position += run + 1;
      if (level == 0 || position > 63) return false;
      picture_.levels.push_back({static_cast<uint8_t>(run), static_cast<int16_t>(level)});
    }
    count = static_cast<uint8_t>(picture_.levels.size() - first);
    return true;
  }

  bool read_intra(Macroblock& macroblock) {
    macroblock.kind = MacroblockKind::intra;
    macroblock.quantizer = static_cast<uint8_t>(quantizer_);
    vector_ = {};
    for (int block = 0; block < kBlocks; ++block)
      if (!read_dc(block, macroblock) || !read_block(0, false, macroblock.counts[block])) return false;
    return true;
  }

  bool read_inter(uint8_t flags, Macroblock& macroblock) {
    macroblock.kind = MacroblockKind::inter;
    reset_dc();
    if ((flags & mpeg1::kForward) == 0) vector_ = {};
    if ((flags & mpeg1::kForward) != 0 && (!read_component(vector_.x_halfpel) || !read_component(vector_.y_halfpel)))
      return false;
    macroblock.vector = vector_;
    if ((flags & mpeg1::kPattern) == 0) return true;
    bits_.refill();
    const mpeg1::Symbol pattern = mpeg1::kReading.pattern[bits_.peek(9)];
    if (pattern.length == 0) return false;
    bits_.skip(pattern.length);
    macroblock.pattern = pattern.value;
    macroblock.quantizer = static_cast<uint8_t>(quantizer_);
    for (int block = 0; block < kBlocks; ++block)
      if ((macroblock.pattern & 32 >> block) != 0 &&
          (!read_block(-1, true, macroblock.counts[block]) || macroblock.counts[block] == 0))
        return false;
    return true;
  }

  bool read_macroblock() {
    if (!read_address()) return false;
    bits_.refill();
    const mpeg1::Symbol type =
        mpeg1::kReading.macroblock_type[static_cast<size_t>(picture_.header.type)][bits_.peek(6)];
    if (type.length == 0) return false;
    bits_.skip(type.length);
    if ((type.value & mpeg1::kQuant) != 0) quantizer_ = static_cast<int>(bits_.read(5));
    if (quantizer_ == 0) return false;
    Macroblock& macroblock = picture_.macroblocks[static_cast<size_t>(address_)];
    macroblock.first_token = static_cast<uint32_t>(picture_.levels.size());
    return (type.value & mpeg1::kIntra) != 0 ? read_intra(macroblock) : read_inter(type.value, macroblock);
  }

  mpeg1::UnitReader bits_;
  int count_;
  PictureSyntax& picture_;
  int address_ = -1, quantizer_ = 0;
  mpeg1::MotionVector vector_;
  int dc_[3] = {128, 128, 128};
};

}  // namespace

bool read_picture(std::span<const uint8_t> bytes, int columns, int rows, PictureSyntax& picture) {
  constexpr size_t kLeastHeader = 8;
  if (bytes.size() < kLeastHeader + kStartCodeBytes || bytes[0] != 0 || bytes[1] != 0 || bytes[2] != 1 ||
      bytes[3] != mpeg1::kPictureStart)
    return false;
  const auto header = mpeg1::parse_picture_header(bytes.subspan(kStartCodeBytes));
  if (!header.ok()) return false;
  picture.header = *header;
  if (header->type != mpeg1::PictureType::I && header->type != mpeg1::PictureType::P) return false;
  for (size_t at = kLeastHeader; at + kStartCodeBytes <= bytes.size(); ++at)
    if (bytes[at] == 0 && bytes[at + 1] == 0 && bytes[at + 2] == 1)
      return bytes[at + 3] == mpeg1::kSliceStartFirst &&
             SyntaxReader(bytes.subspan(at + kStartCodeBytes), columns * rows, picture).read();
  return false;
}

namespace {

// The same macroblock with the codes of its levels, which are appended to `tokens`.
Macroblock with_tokens(const Macroblock& macroblock, const RunLevel* levels, std::vector<mpeg1::Token>& tokens) {
  Macroblock coded = macroblock;
  coded.first_token = static_cast<uint32_t>(tokens.size());
  const bool is_intra = macroblock.kind == MacroblockKind::intra;
  for (int block = 0; block < kBlocks; ++block) {
    if (!is_intra && (macroblock.pattern & 32 >> block) == 0) continue;
    const size_t before = tokens.size();
    for (int i = 0; i < macroblock.counts[block]; ++i, ++levels) {
      const bool is_short = !is_intra && i == 0 && levels->run == 0 && std::abs(levels->level) == 1;
      tokens.push_back(is_short ? mpeg1::first_one_code(levels->level)
                                : mpeg1::coefficient_code(levels->run, levels->level));
    }
    tokens.push_back(mpeg1::kEndOfBlockCode);
    coded.counts[block] = static_cast<uint8_t>(tokens.size() - before);
  }
  return coded;
}

}  // namespace

void write_picture(const PictureSyntax& picture, int columns, int rows, Bytes& out) {
  mpeg1::write_picture_header(picture.header, out);
  std::vector<Macroblock> macroblocks;
  macroblocks.reserve(picture.macroblocks.size());
  std::vector<mpeg1::Token> tokens;
  for (const Macroblock& macroblock : picture.macroblocks)
    macroblocks.push_back(with_tokens(macroblock, picture.levels.data() + macroblock.first_token, tokens));
  const mpeg1::PictureToWrite task{picture.header, columns, rows, rows, macroblocks.data()};
  mpeg1::RowBits bits;
  mpeg1::write_rows(task, tokens.data(), 0, rows, bits);
  mpeg1::join_rows({&bits, 1}, out);
}

}  // namespace pac::sim
