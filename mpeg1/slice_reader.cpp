#include "mpeg1/slice_reader.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "base/kernels/block_kernels.h"
#include "mpeg1/motion_vector.h"
#include "mpeg1/quantizer.h"
#include "mpeg1/vlc_tables.h"

// What makes up the loop over macroblocks: a call would keep the reader in memory.
#define PAC_INLINE inline __attribute__((always_inline))

namespace pac::mpeg1 {
namespace {

MotionVector full_pel(MotionVector vector, bool doubled) {
  if (!doubled) return vector;
  return {static_cast<int16_t>(vector.x_halfpel * 2), static_cast<int16_t>(vector.y_halfpel * 2)};
}

// 8x8 samples of one value.
void fill_block(int value, uint8_t* samples, ptrdiff_t stride) {
  const auto sample = static_cast<uint8_t>(std::clamp(value, 0, 255));
  for (int y = 0; y < 8; ++y) std::memset(samples + y * stride, sample, 8);
}

// The odd value next to `value` toward zero, clipped [2.4.4.1]; sign: -1 or 0. 0 stays 0.
inline int finish_value(int value, int sign) {
  const int odd = std::max((value - 1) | 1, 0);
  return (std::min(odd, 2047 - sign) ^ sign) - sign;
}

// A level at a zigzag position becomes a coefficient.
struct IntraByPosition {
  const uint16_t* scaled;
  int operator()(int level, int position) const {
    const int sign = level >> 31;
    return finish_value(((level ^ sign) - sign) * scaled[position] >> 3, sign);
  }
};
struct NonIntraByPosition {
  const uint16_t* scaled;
  int operator()(int level, int position) const {
    const int sign = level >> 31;
    return finish_value((2 * ((level ^ sign) - sign) + 1) * scaled[position] >> 4, sign);
  }
};
struct NonIntraByLevel {
  const int16_t* values;  // of level 0
  int operator()(int level, int) const { return values[level]; }
};

// The level of an escape [table B.5g]: 8 bits, or 16. Zero where it is forbidden.
PAC_INLINE int read_escape_level(UnitReader& bits) {
  const int first = static_cast<int8_t>(bits.peek(8));
  bits.skip(8);
  if ((first & 127) != 0) return first;
  const int second = static_cast<int>(bits.peek(8));
  bits.skip(8);
  if (first == 0) return second >= 128 ? second : 0;
  return second <= 128 ? second == 0 ? 0 : second - 256 : 0;
}

constexpr int kInvalidCode = -1, kInvalidLevel = -2, kPastTheBlock = -3;  // results of read_coefficients
const char* text_of(int result) {
  return result == kInvalidCode    ? "invalid dct_coeff"
         : result == kInvalidLevel ? "forbidden escape level"
                                   : "coefficient after the 64th";
}

// Coefficients after zigzag `position` until the end of the block [2.4.2.8, 2.4.4.1], of which at least 28 bits are in
// the window: the position of the last one, or a negative result.
template <class Dequantize>
PAC_INLINE int read_coefficients(UnitReader& bits, const Dequantize& dequantize, int position, int16_t* coefficients) {
  for (;;) {
    const CoefficientSymbol* symbol = &kReading.coefficient_short[bits.peek(kShortBits)];
    if (symbol->advance == kAdvanceNone) [[unlikely]]
      symbol = &kReading.coefficient_long[bits.peek(kLongBits) & ((1 << (kLongBits - kLongPrefix)) - 1)];
    bits.skip(symbol->length);
    const int before = position;
    position += symbol->advance;
    int level = symbol->level;
    if (symbol->advance == kAdvanceEndOfBlock) return before;
    if (position > 63) [[unlikely]] {
      if (symbol->advance == kAdvanceNone) return kInvalidCode;
      if (symbol->advance != kAdvanceEscape) return kPastTheBlock;
      position = before + static_cast<int>(bits.peek(6)) + 1;
      bits.skip(6);
      level = read_escape_level(bits);
      if (level == 0) return kInvalidLevel;
      if (position > 63) return kPastTheBlock;
    }
    coefficients[kNaturalFromZigzag[position]] = static_cast<int16_t>(dequantize(level, position));
    if (bits.available() < 28) bits.refill();
  }
}

}  // namespace

void make_dequantizer(const QuantizerMatrix& matrix, bool is_intra, Dequantizer& dequantizer) {
  for (size_t q = 0; q < 32; ++q)
    for (size_t k = 0; k < 64; ++k) dequantizer.scaled[q][k] = static_cast<uint16_t>(q * matrix[kNaturalFromZigzag[k]]);
  dequantizer.is_flat = !is_intra && std::count(matrix.begin(), matrix.end(), matrix[0]) == 64;
  if (!dequantizer.is_flat) return;
  for (size_t q = 1; q < 32; ++q)
    for (int level = -255; level < 256; ++level)
      dequantizer.values[q][level + 256] =
          static_cast<int16_t>(level == 0 ? 0 : NonIntraByPosition{dequantizer.scaled[q]}(level, 0));
}

SliceReader::SliceReader(const PictureContext& picture) : picture_(picture) {
  std::memset(inter_.coefficients, 0, sizeof inter_.coefficients);
  std::memset(intra_.coefficients, 0, sizeof intra_.coefficients);
}

void SliceReader::start_picture() {
  kept_before_ = picture_.kept_before;
  covered_ = picture_.covered->data();
  for (int block = 0; block < 6; ++block) {
    strides_[block] = picture_.target.stride[plane_of(block)];
    if (block < 4) offsets_[block] = (block & 1) * 8 + (block >> 1) * 8 * strides_[block];
  }
}

void SliceReader::transform(Transform transform, Pending& pending, size_t keep) {
  if (keep != 0) transform(pending.coefficients, keep, pending.samples, pending.strides);
  for (size_t i = 0; i < pending.n; ++i) clear_block(pending.coefficients + 64 * i);
  pending.n = 0;
}

void SliceReader::transform_all() {
  transform(picture_.kernels->idct_add, inter_, inter_.n);
  transform(picture_.kernels->idct_put, intra_, intra_.n);
}

const char* SliceReader::read(std::span<const uint8_t> bytes, int row) {
  error_ = nullptr;
  reset_dc();
  reset_vectors();
  flags_ = 0;
  address_ = row * picture_.columns - 1;
  row_ = row - 1, column_ = picture_.columns - 1;
  const char* problem = read_macroblocks(bytes);
  transform_all();
  if (problem != nullptr) give_up_macroblock();
  return problem;
}

PAC_INLINE bool SliceReader::read_slice_header(UnitReader& bits) {
  if (!read_quantizer(bits)) return false;
  while (bits.read(1) != 0) {  // extra_information_slice
    bits.read(8);
    if (bits.overrun()) return fail("slice header runs past the slice");
  }
  bits.refill();
  return true;
}

PAC_INLINE bool SliceReader::read_quantizer(UnitReader& bits) {
  quantizer_ = static_cast<int>(bits.peek(5));
  bits.skip(5);
  return quantizer_ != 0 || fail("quantizer_scale is zero");
}

// macroblock_address_increment [2.4.2.7]: bounded by the picture's end. The first 11 bits are in the window; so are 45
// after it.
PAC_INLINE bool SliceReader::read_address(UnitReader& bits, int& address) {
  address = address_;
  for (;;) {
    const Symbol symbol = kReading.address_increment[bits.peek(11)];
    if (symbol.length == 0) return fail("invalid macroblock_address_increment");
    bits.skip(symbol.length);
    if (symbol.value < kAddressEscape) [[likely]] {
      address += symbol.value;
      return address < picture_.columns * picture_.rows || fail("macroblock address outside the picture");
    }
    bits.refill();
    if (symbol.value == kAddressStuffing) continue;  // ends with the slice's bits
    address += 33;
    if (address >= picture_.columns * picture_.rows) return fail("macroblock address outside the picture");
  }
}

// On to a later macroblock, inside the picture: `count` places.
inline void SliceReader::advance(int count) {
  address_ += count;
  column_ += count;
  if (column_ < picture_.columns) return;
  for (; column_ >= picture_.columns; column_ -= picture_.columns) ++row_;
  for (int block = 0; block < 6; ++block)
    row_offsets_[block] = offsets_[block] + (block < 4 ? 16 : 8) * row_ * strides_[block];
}

// The next `count` macroblocks are not in the stream [2.4.4.4].
bool SliceReader::skip_macroblocks(int count) {
  const bool is_b = picture_.header.type == PictureType::B;
  if (picture_.header.type == PictureType::I || picture_.header.type == PictureType::D)
    return fail("skipped macroblock in an I or D picture");
  if (is_b && (flags_ & kIntra) != 0) return fail("skipped macroblock after an intra one in a B picture");
  reset_dc();
  if (!is_b) reset_vectors();
  while (count > 0) {
    advance(1);
    const int here = is_b ? 1 : std::min(count, picture_.columns - column_);
    if (is_b)
      predict();
    else
      keep_macroblocks(address_, here);
    std::memset(covered_ + address_, is_b ? kDecoded : picture_.skipped, static_cast<size_t>(here));
    advance(here - 1);
    count -= here;
  }
  return true;
}

// The target holds what the forward reference holds there: nothing has been written and nothing need be.
inline bool SliceReader::shows_reference(int address) const {
  const auto i = static_cast<size_t>(address);
  return kept_before_ != nullptr && kept_before_[i] == kKept && covered_[i] == kMissing;
}

// `count` macroblocks from (column_, row_) on, inside one row, become those of the forward reference.
void SliceReader::keep_macroblocks(int first, int count) {
  for (int i = 0; i < count;) {
    const bool is_there = shows_reference(first + i);
    int end = i + 1;
    while (end < count && shows_reference(first + end) == is_there) ++end;
    if (!is_there) copy_macroblocks(picture_.forward, column_ + i, row_, end - i, picture_.target);
    i = end;
  }
}

// A macroblock that could not be read may have been written to: it is no copy any more, nor what the target held.
void SliceReader::give_up_macroblock() {
  kept_before_ = nullptr;
  if (address_ < 0) return;
  uint8_t& covered = covered_[address_];
  if (covered == kKept || covered == kCopied) covered = kDecoded;
}

// At most 17 bits, which are in the window.
PAC_INLINE bool SliceReader::read_component(UnitReader& bits, int r_size, int16_t& component) {
  const Symbol symbol = kReading.motion[bits.peek(11)];
  if (symbol.length == 0) return fail("invalid motion_code");
  bits.skip(symbol.length);
  MotionCode motion{symbol.value - 16, 0};
  if (r_size != 0 && motion.code != 0) {
    motion.r = static_cast<int>(bits.peek(r_size));
    bits.skip(r_size);
  }
  component = static_cast<int16_t>(vector_from(motion, component, r_size));
  return true;
}

// 34 bits are in the window.
PAC_INLINE bool SliceReader::read_vectors(UnitReader& bits) {
  const PictureHeader& header = picture_.header;
  if ((flags_ & kForward) != 0) {
    if (!read_component(bits, header.forward_f_code - 1, vectors_[0].x_halfpel)) return false;
    if (!read_component(bits, header.forward_f_code - 1, vectors_[0].y_halfpel)) return false;
  } else if (header.type == PictureType::P) {
    vectors_[0] = {};
  }
  if ((flags_ & kBackward) != 0) {
    bits.refill();
    if (!read_component(bits, header.backward_f_code - 1, vectors_[1].x_halfpel)) return false;
    if (!read_component(bits, header.backward_f_code - 1, vectors_[1].y_halfpel)) return false;
  }
  return true;
}

void SliceReader::predict() {
  const PictureHeader& header = picture_.header;
  if (header.type == PictureType::P && vectors_[0] == MotionVector{} && shows_reference(address_)) return;
  const bool from_forward = header.type == PictureType::P || (flags_ & kForward) != 0;
  if (from_forward)
    predict_macroblock(*picture_.kernels, picture_.forward, column_, row_,
                       full_pel(vectors_[0], header.full_pel_forward), picture_.target);
  if ((flags_ & kBackward) == 0) return;
  const MotionVector backward = full_pel(vectors_[1], header.full_pel_backward);
  if (from_forward)
    average_macroblock(*picture_.kernels, picture_.backward, column_, row_, backward, picture_.target);
  else
    predict_macroblock(*picture_.kernels, picture_.backward, column_, row_, backward, picture_.target);
}

// dct_dc_size and dct_dc_differential [2.4.3.7]: dc becomes the coefficient, 8 * level.
PAC_INLINE bool SliceReader::read_dc(UnitReader& bits, int block, int& dc) {
  const Symbol symbol = block < 4 ? kReading.dc_luminance[bits.peek(7)] : kReading.dc_chrominance[bits.peek(8)];
  if (symbol.length == 0) return fail("invalid dct_dc_size");
  bits.skip(symbol.length);
  int& prediction = dc_[plane_of(block)];
  if (symbol.value != 0) {
    const int size = symbol.value;
    int differential = static_cast<int>(bits.peek(size));
    bits.skip(size);
    if (differential >> (size - 1) == 0) differential += 1 - (1 << size);
    prediction += 8 * differential;
  }
  dc = prediction;
  if (dc < 0 || dc > 2040) return fail("dct_dc outside 0..255");
  return true;
}

PAC_INLINE bool SliceReader::read_intra_blocks(UnitReader& bits) {
  const IntraByPosition dequantize{picture_.intra->scaled[quantizer_]};
  const bool is_d = picture_.header.type == PictureType::D;
  const size_t before = intra_.n;
  size_t n = before;
  bool good = true;
  for (int block = 0; block < 6 && good; ++block) {
    int dc = 0;
    bits.refill();  // 56 bits: 8 and 8 of DC, 28 of the first coefficient
    good = read_dc(bits, block, dc);
    if (!good) break;
    uint8_t* samples = samples_of(block);
    int16_t* coefficients = intra_.coefficients + 64 * n;
    const int last = is_d ? 0 : read_coefficients(bits, dequantize, 0, coefficients);
    if (last == 0) {
      fill_block((dc + 4) >> 3, samples, strides_[block]);
      continue;
    }
    coefficients[0] = static_cast<int16_t>(dc);
    intra_.samples[n] = samples;
    intra_.strides[n++] = strides_[block];
    good = last > 0 || fail(text_of(last));
  }
  intra_.n = n;
  if (!good || n + 6 > kWaiting) transform(picture_.kernels->idct_put, intra_, good ? n : before);
  return good;
}

template <class Dequantize>
PAC_INLINE bool SliceReader::read_coded_blocks(UnitReader& bits, int pattern, const Dequantize& dequantize) {
  const size_t before = inter_.n;
  size_t n = before;
  int result = 0;
  for (unsigned left = static_cast<unsigned>(pattern) << 26; left != 0 && result >= 0;) {
    const int block = std::countl_zero(left);  // bit 5 of the pattern is the first block
    left &= ~(1u << (31 - block));
    int16_t* coefficients = inter_.coefficients + 64 * n;
    bits.refill();
    bits.double_leading_one();  // dct_coeff_first: '1s' is run 0, level 1, which is '11s' later on
    result = read_coefficients(bits, dequantize, -1, coefficients);
    if (result == 0) {
      picture_.kernels->idct_dc_add(coefficients[0], samples_of(block), strides_[block]);
      coefficients[0] = 0;
      continue;
    }
    inter_.samples[n] = samples_of(block);
    inter_.strides[n++] = strides_[block];
  }
  inter_.n = n;
  if (result < 0) fail(text_of(result));
  if (result < 0 || n + 6 > kWaiting) transform(picture_.kernels->idct_add, inter_, result < 0 ? before : n);
  return result >= 0;
}

// At least 56 bits are in the window: 11 of the address, 6 of the type, 5 of the quantizer, 34 of a vector.
PAC_INLINE bool SliceReader::read_macroblock(UnitReader& bits) {
  int address = 0;
  if (!read_address(bits, address)) return false;
  const int skipped = address - address_ - 1;
  if (skipped > 0 && flags_ == 0)  // the increment of a slice's first macroblock only says where it is
    advance(skipped);
  else if (skipped > 0 && !skip_macroblocks(skipped))
    return false;
  advance(1);

  const Symbol type = kReading.macroblock_type[static_cast<size_t>(picture_.header.type)][bits.peek(6)];
  if (type.length == 0) return fail("invalid macroblock_type");
  bits.skip(type.length);
  flags_ = type.value;
  if ((flags_ & kQuant) != 0 && !read_quantizer(bits)) return false;
  if ((flags_ & kIntra) != 0) {
    reset_vectors();
    if (!read_intra_blocks(bits)) return false;
    if (picture_.header.type == PictureType::D && bits.read(1) == 0) return fail("end_of_macroblock is zero");
    return true;
  }
  reset_dc();
  if (!read_vectors(bits)) return false;
  predict();
  if ((flags_ & kPattern) == 0) return true;
  bits.refill();
  const Symbol pattern = kReading.pattern[bits.peek(9)];
  if (pattern.length == 0) return fail("invalid coded_block_pattern");
  bits.skip(pattern.length);
  const Dequantizer& matrix = *picture_.non_intra;
  if (matrix.is_flat) return read_coded_blocks(bits, pattern.value, NonIntraByLevel{matrix.values[quantizer_] + 256});
  return read_coded_blocks(bits, pattern.value, NonIntraByPosition{matrix.scaled[quantizer_]});
}

// Last, after all of its parts.
const char* SliceReader::read_macroblocks(std::span<const uint8_t> bytes) {
  UnitReader bits(bytes);
  bool good = read_slice_header(bits);
  for (bool more = good; more;) {
    good = read_macroblock(bits);
    if (good && bits.overrun()) good = fail("macroblock runs past the slice");
    if (good) covered_[address_] = kDecoded;
    more = good && !bits.only_zeros_left();
  }
  bits_ = bits;
  return good ? nullptr : error_;
}

}  // namespace pac::mpeg1
