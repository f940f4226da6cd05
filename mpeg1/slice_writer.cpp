#include "mpeg1/slice_writer.h"

#include <algorithm>
#include <bit>

#include "mpeg1/motion_vector.h"
#include "mpeg1/vlc_tables.h"

// What writes blocks: a call would keep the bits in memory.
#define PAC_INLINE inline __attribute__((always_inline))

namespace pac::mpeg1 {
namespace {

// What the codes of a macroblock depend on besides itself.
struct Predictions {
  int dc[3] = {128, 128, 128};  // quantized
  MotionVector vector;
  int quantizer = 0;
  int last_address = -1;  // of the last macroblock written or begun with
};

bool has_coefficients(const Macroblock& macroblock) {
  return macroblock.kind == MacroblockKind::intra ||
         (macroblock.kind == MacroblockKind::inter && macroblock.pattern != 0);
}

constexpr int kByte = 8;

void put_last(const ShortCode& code, FastBitWriter& bits) {
  const Code& stuffing = kAddressIncrementCodes[kAddressStuffing];
  const auto used = static_cast<int>(bits.size_bits() % kByte);
  if (used != 0 && used + code.length <= kByte) bits.put(stuffing.bits, stuffing.length);
  bits.put(code.bits, code.length);
}

class RowWriter {
 public:
  // `tail`, if not null, takes a short last macroblock: where in its byte it will begin is not known yet.
  RowWriter(const PictureToWrite& picture, const Token* tokens, FastBitWriter& bits, ShortCode* tail)
      : picture_(picture), tokens_(tokens), bits_(bits), tail_(tail) {}

  // Rows [first, end), of which only the first may begin a slice that is not the picture's own.
  void write(int first, int end) {
    if (first % picture_.slice_rows != 0) resume(first);
    for (int row = first; row < end; ++row) {
      if (row % picture_.slice_rows == 0) start_slice(row);
      for (int address = row * picture_.columns; address < (row + 1) * picture_.columns; ++address)
        if (picture_.macroblocks[address].kind != MacroblockKind::skipped) write_macroblock_or_last(address);
    }
  }

 private:
  void put(const Code& code) { bits_.put(code.bits, code.length); }

  // The quantizer in the slice header: of the slice's first macroblock with coefficients.
  int first_quantizer(int row) const {
    const int end = std::min(row + picture_.slice_rows, picture_.rows) * picture_.columns;
    for (int address = row * picture_.columns; address < end; ++address)
      if (has_coefficients(picture_.macroblocks[address])) return picture_.macroblocks[address].quantizer;
    return 1;
  }

  void start_slice(int row) {
    bits_.align_to_byte();
    bits_.put(0x000001, 24);
    bits_.put(static_cast<uint32_t>(row + 1), 8);
    predictions_ = {};
    predictions_.quantizer = first_quantizer(row);
    predictions_.last_address = row * picture_.columns - 1;
    bits_.put(static_cast<uint32_t>(predictions_.quantizer), 5);
    bits_.put(0, 1);  // extra_bit_slice
  }

  // The state in the middle of a slice, before that row.
  void resume(int row) {
    const int slice_row = row / picture_.slice_rows * picture_.slice_rows;
    const int begin = slice_row * picture_.columns, end = row * picture_.columns;
    const auto last_before = [&](auto&& is_so) {
      int address = end - 1;
      while (address >= begin && !is_so(picture_.macroblocks[address])) --address;
      return address;
    };
    const int last_coded = last_before(has_coefficients);
    predictions_.quantizer =
        last_coded >= begin ? picture_.macroblocks[last_coded].quantizer : first_quantizer(slice_row);
    predictions_.last_address = last_before([](const Macroblock& m) { return m.kind != MacroblockKind::skipped; });
    const Macroblock& last = picture_.macroblocks[end - 1];  // the first macroblock of a slice is never skipped
    predictions_.vector = last.vector;
    if (last.kind == MacroblockKind::intra)
      for (const int plane : {0, 1, 2}) predictions_.dc[plane] = last.dc[plane + 3];
  }

  void write_address(int address) {
    int increment = address - predictions_.last_address;
    if (increment > 1) {  // skipped macroblocks in between reset predictions [2.4.4.2]
      predictions_.vector = {};
      reset_dc();
    }
    for (; increment > 33; increment -= 33) put(kAddressIncrementCodes[kAddressEscape]);
    put(kAddressIncrementCodes[static_cast<size_t>(increment)]);
    predictions_.last_address = address;
  }
  void reset_dc() { predictions_.dc[0] = predictions_.dc[1] = predictions_.dc[2] = 128; }

  void write_type(const Macroblock& macroblock, bool quant) {
    if (picture_.header.type == PictureType::I) {
      put(kTypesOfI[quant ? 1 : 0].code);
      return;
    }
    const bool moves = uses_vector(macroblock);
    uint8_t flags = macroblock.kind == MacroblockKind::intra ? kIntra : 0;
    if (moves) flags |= kForward;
    if (macroblock.kind == MacroblockKind::inter && macroblock.pattern != 0) flags |= kPattern;
    if (quant) flags |= kQuant;
    put(kWriting.type_of_p[flags]);
  }
  // Without coefficients a macroblock that may not be skipped has a vector, even zero.
  static bool uses_vector(const Macroblock& macroblock) {
    return macroblock.kind == MacroblockKind::inter && (macroblock.vector != MotionVector{} || macroblock.pattern == 0);
  }

  void write_component(int vector, int predicted) {
    const int r_size = picture_.header.forward_f_code - 1;
    const MotionCode motion = motion_code_from(vector, predicted, r_size);
    const int magnitude = motion.code < 0 ? -motion.code : motion.code;
    put(kMotionCodes[static_cast<size_t>(magnitude)]);
    if (magnitude == 0) return;
    bits_.put(motion.code < 0 ? 1 : 0, 1);
    bits_.put(static_cast<uint32_t>(motion.r), r_size);
  }

  PAC_INLINE static void write_tokens(FastBitWriter::Loan& bits, const Token* tokens, int count) {
    int i = 0;
    for (; i + 1 < count; i += 2) {
      const Token first = tokens[i], second = tokens[i + 1];
      bits.put(uint64_t{first >> 5} << (second & 31) | second >> 5, static_cast<int>((first & 31) + (second & 31)));
    }
    if (i < count) bits.put(tokens[i] >> 5, static_cast<int>(tokens[i] & 31));
  }

  PAC_INLINE void write_dc(FastBitWriter::Loan& bits, int block, int dc) {
    int& prediction = predictions_.dc[block < 4 ? 0 : block - 3];
    const int differential = dc - prediction;
    prediction = dc;
    const int magnitude = differential < 0 ? -differential : differential;
    const int size = 32 - std::countl_zero(static_cast<uint32_t>(magnitude));
    const Code& code =
        block < 4 ? kDcSizeLuminance[static_cast<size_t>(size)] : kDcSizeChrominance[static_cast<size_t>(size)];
    const int rest = differential < 0 ? differential + (1 << size) - 1 : differential;
    bits.put(static_cast<uint32_t>(code.bits) << size | static_cast<uint32_t>(rest), code.length + size);
  }

  // The last macroblock of a slice without coefficients may be short.
  void write_macroblock_or_last(int address) {
    const int end_row = address / picture_.columns + 1;
    const bool is_last =
        (address + 1) % picture_.columns == 0 && (end_row % picture_.slice_rows == 0 || end_row == picture_.rows);
    if (!is_last || has_coefficients(picture_.macroblocks[address])) return write_macroblock(address);
    FastBitWriter alone;
    RowWriter writer(picture_, tokens_, alone, nullptr);
    writer.predictions_ = predictions_;
    writer.write_macroblock(address);
    if (alone.size_bits() >= kByte) return bits_.append(alone);
    const ShortCode code{alone.value(), static_cast<int>(alone.size_bits())};
    if (tail_ != nullptr)
      *tail_ = code;
    else
      put_last(code, bits_);
  }

  void write_macroblock(int address) {
    const Macroblock& macroblock = picture_.macroblocks[address];
    const bool is_intra = macroblock.kind == MacroblockKind::intra;
    write_address(address);
    const bool quant = has_coefficients(macroblock) && macroblock.quantizer != predictions_.quantizer;
    write_type(macroblock, quant);
    if (quant) {
      predictions_.quantizer = macroblock.quantizer;
      bits_.put(macroblock.quantizer, 5);
    }
    if (uses_vector(macroblock)) {
      write_component(macroblock.vector.x_halfpel, predictions_.vector.x_halfpel);
      write_component(macroblock.vector.y_halfpel, predictions_.vector.y_halfpel);
    }
    predictions_.vector = macroblock.vector;
    if (!is_intra) reset_dc();
    if (!is_intra && macroblock.pattern != 0) put(kPatternCodes[macroblock.pattern]);
    if (has_coefficients(macroblock)) write_blocks(macroblock);
  }

  void write_blocks(const Macroblock& macroblock) {
    constexpr size_t kMostBits = 6 * (64 * 28 + 16 + 2);  // escapes, DC and end_of_block
    const bool is_intra = macroblock.kind == MacroblockKind::intra;
    const Token* tokens = tokens_ + macroblock.first_token;
    FastBitWriter::Loan bits = bits_.lend(kMostBits);
    int left = 0;  // tokens that no DC comes before
    for (int block = 0; block < 6; ++block) {
      if (is_intra) {
        write_dc(bits, block, macroblock.dc[block]);
        write_tokens(bits, tokens, macroblock.counts[block]);
        tokens += macroblock.counts[block];
      } else if ((macroblock.pattern & 32 >> block) != 0) {
        left += macroblock.counts[block];
      }
    }
    write_tokens(bits, tokens, left);
    bits_.take_back(bits);
  }

  const PictureToWrite& picture_;
  const Token* tokens_;
  FastBitWriter& bits_;
  ShortCode* tail_;
  Predictions predictions_;
};

}  // namespace

int motion_bits(int vector, int predicted, int r_size) {
  const MotionCode motion = motion_code_from(vector, predicted, r_size);
  const int magnitude = motion.code < 0 ? -motion.code : motion.code;
  return kMotionCodes[static_cast<size_t>(magnitude)].length + (magnitude == 0 ? 0 : 1 + r_size);
}

int needed_f_code(const PictureToWrite& picture) {
  int low = 0, high = 0;
  for (int i = 0; i < picture.columns * picture.rows; ++i) {
    const MotionVector& v = picture.macroblocks[i].vector;
    low = std::min({low, int{v.x_halfpel}, int{v.y_halfpel}});
    high = std::max({high, int{v.x_halfpel}, int{v.y_halfpel}});
  }
  int f_code = 1;
  while (f_code < 7 && (low < -(16 << (f_code - 1)) || high > (16 << (f_code - 1)) - 1)) ++f_code;
  return f_code;
}

void write_rows(const PictureToWrite& picture, const Token* tokens, int first_row, int end_row, RowBits& bits) {
  const int next_slice = (first_row + picture.slice_rows - 1) / picture.slice_rows * picture.slice_rows;
  const int split = std::min(next_slice, end_row);
  bits.head.clear();
  bits.slices.clear();
  bits.tail = {};
  if (split > first_row) RowWriter(picture, tokens, bits.head, &bits.tail).write(first_row, split);
  if (split < end_row) RowWriter(picture, tokens, bits.slices, nullptr).write(split, end_row);
}

void join_rows(std::span<const RowBits> rows, std::vector<uint8_t>& out) {
  FastBitWriter all;
  for (const RowBits& row : rows) {
    all.append(row.head);
    if (row.tail.length != 0) put_last(row.tail, all);
    if (row.slices.size_bits() == 0) continue;
    all.align_to_byte();
    all.append(row.slices);
  }
  all.append_to(out);
}

}  // namespace pac::mpeg1
