#include "mpeg1/slice_reader.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "base/kernels/block_kernels.h"
#include "mpeg1/motion_vector.h"
#include "mpeg1/quantizer.h"
#include "mpeg1/vlc_tables.h"

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
inline int read_escape_level(UnitReader& bits) {
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
inline __attribute__((always_inline)) int read_coefficients(UnitReader& bits, const Dequantize& dequantize,
                                                            int position, int16_t* coefficients) {
  for (;;) {
    const CoefficientSymbol* symbol = &kReading.coefficient_short[bits.peek(kShortBits)];
    if (symbol->advance == kAdvanceNone) [[unlikely]]
      symbol = &kReading.coefficient_long[bits.peek(kLongBits) & ((1 << (kLongBits - kLongPrefix)) - 1)];
    bits.skip(symbol->length);
    const int before = position;
    position += symbol->advance;
    int level = symbol->level;
    if (position > 63) {
      if (symbol->advance == kAdvanceEndOfBlock) return before;
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
  const char* problem = read_macroblocks(bytes, row);
  transform_all();
  if (problem != nullptr) give_up_macroblock();
  return problem;
}

const char* SliceReader::read_macroblocks(std::span<const uint8_t> bytes, int row) {
  bits_ = UnitReader(bytes);
  error_ = nullptr;
  reset_dc();
  reset_vectors();
  address_ = row * picture_.columns - 1;
  flags_ = 0;
  if (!read_quantizer()) return error_;
  while (bits_.read(1) != 0) {  // extra_information_slice
    bits_.read(8);
    if (bits_.overrun()) return "slice header runs past the slice";
  }
  const int first = address_;
  do {
    if (!read_macroblock()) return error_;
    if (bits_.overrun()) return "macroblock runs past the slice";
    (*picture_.covered)[static_cast<size_t>(address_)] = kDecoded;
  } while (!bits_.only_zeros_left());
  return address_ > first ? nullptr : "slice without macroblocks";
}

bool SliceReader::read_quantizer() {
  quantizer_ = static_cast<int>(bits_.read(5));
  return quantizer_ != 0 || fail("quantizer_scale is zero");
}

// macroblock_address_increment [2.4.2.7]: bounded by the picture's end.
bool SliceReader::read_address(int& address) {
  address = address_;
  for (;;) {
    bits_.refill();
    const Symbol symbol = kReading.address_increment[bits_.peek(11)];
    if (symbol.length == 0) return fail("invalid macroblock_address_increment");
    bits_.skip(symbol.length);
    if (symbol.value == kAddressStuffing) continue;  // ends with the slice's bits
    address += symbol.value == kAddressEscape ? 33 : symbol.value;
    if (address >= picture_.columns * picture_.rows) return fail("macroblock address outside the picture");
    if (symbol.value != kAddressEscape) return true;
  }
}

// Macroblocks [from, to) that the stream leaves out [2.4.4.4].
bool SliceReader::skip_macroblocks(int from, int to) {
  const bool is_b = picture_.header.type == PictureType::B;
  if (picture_.header.type == PictureType::I || picture_.header.type == PictureType::D)
    return fail("skipped macroblock in an I or D picture");
  if (is_b && (flags_ & kIntra) != 0) return fail("skipped macroblock after an intra one in a B picture");
  reset_dc();
  if (!is_b) reset_vectors();
  for (int address = from; address < to;) {
    row_ = address / picture_.columns, column_ = address % picture_.columns;
    const int count = is_b ? 1 : std::min(to - address, picture_.columns - column_);
    if (is_b)
      predict();
    else
      keep_macroblocks(address, count);
    std::memset(picture_.covered->data() + address, is_b ? kDecoded : picture_.skipped, static_cast<size_t>(count));
    address += count;
  }
  return true;
}

// The target holds what the forward reference holds there: nothing has been written and nothing need be.
inline bool SliceReader::shows_reference(int address) const {
  const auto i = static_cast<size_t>(address);
  return kept_before_ != nullptr && kept_before_[i] == kKept && (*picture_.covered)[i] == kMissing;
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
  uint8_t& covered = (*picture_.covered)[static_cast<size_t>(address_)];
  if (covered == kKept) covered = kDecoded;
}

bool SliceReader::read_component(int r_size, int16_t& component) {
  bits_.refill();
  const Symbol symbol = kReading.motion[bits_.peek(11)];
  if (symbol.length == 0) return fail("invalid motion_code");
  bits_.skip(symbol.length);
  MotionCode motion{symbol.value - 16, 0};
  if (r_size != 0 && motion.code != 0) {
    motion.r = static_cast<int>(bits_.peek(r_size));
    bits_.skip(r_size);
  }
  component = static_cast<int16_t>(vector_from(motion, component, r_size));
  return true;
}

bool SliceReader::read_vectors(uint8_t flags) {
  const PictureHeader& header = picture_.header;
  if ((flags & kForward) != 0) {
    if (!read_component(header.forward_f_code - 1, vectors_[0].x_halfpel)) return false;
    if (!read_component(header.forward_f_code - 1, vectors_[0].y_halfpel)) return false;
  } else if (header.type == PictureType::P) {
    vectors_[0] = {};
  }
  if ((flags & kBackward) != 0) {
    if (!read_component(header.backward_f_code - 1, vectors_[1].x_halfpel)) return false;
    if (!read_component(header.backward_f_code - 1, vectors_[1].y_halfpel)) return false;
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
inline bool SliceReader::read_dc(UnitReader& bits, int block, int& dc) {
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

bool SliceReader::read_intra_blocks() {
  const IntraByPosition dequantize{picture_.intra->scaled[quantizer_]};
  const bool is_d = picture_.header.type == PictureType::D;
  UnitReader bits = bits_;  // a copy in registers
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
  bits_ = bits;
  intra_.n = n;
  if (!good || n + 6 > kWaiting) transform(picture_.kernels->idct_put, intra_, good ? n : before);
  return good;
}

template <class Dequantize>
bool SliceReader::read_coded_blocks(int pattern, const Dequantize& dequantize) {
  UnitReader bits = bits_;  // a copy in registers
  const size_t before = inter_.n;
  size_t n = before;
  int result = 0;
  for (unsigned left = static_cast<unsigned>(pattern) << 26; left != 0 && result >= 0;) {
    const int block = std::countl_zero(left);  // bit 5 of the pattern is the first block
    left &= ~(1u << (31 - block));
    int16_t* coefficients = inter_.coefficients + 64 * n;
    bits.refill();
    int position = -1;
    if (bits.peek(1) != 0) {  // dct_coeff_first: '1s' is run 0, level 1
      position = 0;
      coefficients[0] = static_cast<int16_t>(dequantize(bits.peek(2) == 2 ? 1 : -1, 0));
      bits.skip(2);
    }
    result = read_coefficients(bits, dequantize, position, coefficients);
    if (result == 0) {
      picture_.kernels->idct_dc_add(coefficients[0], samples_of(block), strides_[block]);
      coefficients[0] = 0;
      continue;
    }
    inter_.samples[n] = samples_of(block);
    inter_.strides[n++] = strides_[block];
  }
  bits_ = bits;
  inter_.n = n;
  if (result < 0) fail(text_of(result));
  if (result < 0 || n + 6 > kWaiting) transform(picture_.kernels->idct_add, inter_, result < 0 ? before : n);
  return result >= 0;
}

// Mostly the next macroblock of the row: no division then.
void SliceReader::move_to(int address) {
  if (address == address_ + 1 && column_ + 1 < picture_.columns && flags_ != 0) {
    ++column_;
  } else {
    row_ = address / picture_.columns, column_ = address % picture_.columns;
  }
  address_ = address;
}

bool SliceReader::read_macroblock() {
  int address = 0;
  if (!read_address(address)) return false;
  const bool is_first = flags_ == 0;  // the increment of a slice's first macroblock only says where it is
  if (address > address_ + 1 && !is_first && !skip_macroblocks(address_ + 1, address)) return false;
  move_to(address);

  bits_.refill();
  const Symbol type = kReading.macroblock_type[static_cast<size_t>(picture_.header.type)][bits_.peek(6)];
  if (type.length == 0) return fail("invalid macroblock_type");
  bits_.skip(type.length);
  flags_ = type.value;
  if ((flags_ & kQuant) != 0 && !read_quantizer()) return false;
  if ((flags_ & kIntra) != 0) {
    reset_vectors();
    if (!read_intra_blocks()) return false;
    if (picture_.header.type == PictureType::D && bits_.read(1) == 0) return fail("end_of_macroblock is zero");
    return true;
  }
  reset_dc();
  if (!read_vectors(flags_)) return false;
  predict();
  if ((flags_ & kPattern) == 0) return true;
  bits_.refill();
  const Symbol pattern = kReading.pattern[bits_.peek(9)];
  if (pattern.length == 0) return fail("invalid coded_block_pattern");
  bits_.skip(pattern.length);
  const Dequantizer& matrix = *picture_.non_intra;
  if (matrix.is_flat) return read_coded_blocks(pattern.value, NonIntraByLevel{matrix.values[quantizer_] + 256});
  return read_coded_blocks(pattern.value, NonIntraByPosition{matrix.scaled[quantizer_]});
}

}  // namespace pac::mpeg1
