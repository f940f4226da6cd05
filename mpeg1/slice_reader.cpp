#include "mpeg1/slice_reader.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "base/kernels/block_kernels.h"
#include "mpeg1/motion_vector.h"
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

// A size that the compiler knows, block by block.
void clear_blocks(int16_t* coefficients, size_t n_blocks) {
  for (size_t i = 0; i < n_blocks; ++i) std::memset(coefficients + 64 * i, 0, 128);
}

}  // namespace

void scale_matrix(const QuantizerMatrix& matrix, ScaledMatrices& scaled) {
  for (size_t q = 0; q < scaled.size(); ++q)
    for (size_t k = 0; k < 64; ++k) scaled[q][k] = static_cast<uint16_t>(q * matrix[kNaturalFromZigzag[k]]);
}

const char* SliceReader::read(std::span<const uint8_t> bytes, int row) {
  bits_ = UnitReader(bytes);
  error_ = nullptr;
  std::memset(pending_.coefficients, 0, sizeof pending_.coefficients);
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
    (*picture_.covered)[static_cast<size_t>(address_)] = 1;
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
      copy_macroblocks(picture_.forward, column_, row_, count, picture_.target);
    std::memset(picture_.covered->data() + address, 1, static_cast<size_t>(count));
    address += count;
  }
  return true;
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

// Where block 0..5 of the macroblock lies.
void SliceReader::place(int block, uint8_t*& samples, ptrdiff_t& stride) const {
  const int plane = block < 4 ? 0 : block - 3;
  stride = picture_.target.stride[plane];
  samples = picture_.target.at(plane, column_, row_);
  if (block < 4) samples += (block & 1) * 8 + (block >> 1) * 8 * stride;
}

// dct_dc_size and dct_dc_differential [2.4.3.7]: dc becomes the coefficient, 8 * level.
bool SliceReader::read_dc(int block, int& dc) {
  bits_.refill();
  const Symbol symbol = block < 4 ? kReading.dc_luminance[bits_.peek(7)] : kReading.dc_chrominance[bits_.peek(8)];
  if (symbol.length == 0) return fail("invalid dct_dc_size");
  bits_.skip(symbol.length);
  int& prediction = dc_[block < 4 ? 0 : block - 3];
  if (symbol.value != 0) {
    const int size = symbol.value;
    int differential = static_cast<int>(bits_.peek(size));
    bits_.skip(size);
    if (differential >> (size - 1) == 0) differential += 1 - (1 << size);
    prediction += 8 * differential;
  }
  dc = prediction;
  if (dc < 0 || dc > 2040) return fail("dct_dc outside 0..255");
  return true;
}

// Coefficients after zigzag `position` until the end of the block [2.4.2.8, 2.4.4.1]: the position of the last one, or
// -1 where the block is wrong.
template <bool kIsIntra>
int SliceReader::read_coefficients(const uint16_t* scaled, int position, int16_t* coefficients) {
  UnitReader bits = bits_;  // a copy in registers
  const auto store = [&](int level) {
    const int magnitude = std::abs(level);
    const int weight = scaled[position];
    int value = kIsIntra ? magnitude * weight >> 3 : (2 * magnitude + 1) * weight >> 4;
    const int is_nonzero = value != 0;
    value = (value - is_nonzero) | is_nonzero;  // even values move toward zero
    const int sign = level >> 31;               // -1 or 0
    value = std::min(value, 2047 - sign);
    coefficients[kNaturalFromZigzag[position]] = static_cast<int16_t>((value ^ sign) - sign);
  };
  bits.refill();
  if (!kIsIntra && bits.peek(1) != 0) {  // dct_coeff_first: '1s' is run 0, level 1
    position = 0;
    store(bits.peek(2) == 2 ? 1 : -1);
    bits.skip(2);
  }
  for (;;) {
    if (bits.available() < 28) bits.refill();
    CoefficientSymbol symbol = kReading.coefficient_short[bits.peek(kShortBits)];
    if (symbol.length == 0) symbol = kReading.coefficient_long[bits.peek(kLongBits) & ((1 << 11) - 1)];
    if (symbol.run < kRunEndOfBlock) {
      if (symbol.length == 0) return fail("invalid dct_coeff"), -1;
      bits.skip(symbol.length);
      position += symbol.run + 1;
      if (position > 63) return fail("coefficient after the 64th"), -1;
      store(symbol.level);
      continue;
    }
    if (symbol.run == kRunEndOfBlock) {
      bits.skip(2);
      bits_ = bits;
      return position;
    }
    position += static_cast<int>(bits.peek(12) & 63) + 1;
    bits.skip(12);
    int level = static_cast<int>(bits.peek(8));
    bits.skip(8);
    if (level == 0 || level == 128) {
      const int low = static_cast<int>(bits.peek(8));
      bits.skip(8);
      if (low == 0 || (level == 0 && low < 128) || (level == 128 && low > 128))
        return fail("forbidden escape level"), -1;
      level = level == 0 ? low : low - 256;
    } else if (level > 128) {
      level -= 256;
    }
    if (position > 63) return fail("coefficient after the 64th"), -1;
    store(level);
  }
}

bool SliceReader::read_intra_blocks() {
  const uint16_t* scaled = (*picture_.intra)[static_cast<size_t>(quantizer_)].data();
  const bool is_d = picture_.header.type == PictureType::D;
  pending_.count = 0;
  bool good = true;
  for (int block = 0; block < 6 && good; ++block) {
    int dc = 0;
    if (!(good = read_dc(block, dc))) break;
    uint8_t*& samples = pending_.samples[pending_.count];
    ptrdiff_t& stride = pending_.strides[pending_.count];
    place(block, samples, stride);
    int16_t* coefficients = pending_.coefficients + 64 * pending_.count;
    const int last = is_d ? 0 : read_coefficients<true>(scaled, 0, coefficients);
    if (last == 0) {
      fill_block((dc + 4) >> 3, samples, stride);
      continue;
    }
    coefficients[0] = static_cast<int16_t>(dc);
    ++pending_.count;
    good = last > 0;
  }
  if (good) picture_.kernels->idct_put(pending_.coefficients, pending_.count, pending_.samples, pending_.strides);
  clear_blocks(pending_.coefficients, pending_.count);
  return good;
}

bool SliceReader::read_coded_blocks(int pattern) {
  const uint16_t* scaled = (*picture_.non_intra)[static_cast<size_t>(quantizer_)].data();
  pending_.count = 0;
  bool good = true;
  for (int block = 0; block < 6 && good; ++block) {
    if ((pattern & 32 >> block) == 0) continue;
    uint8_t*& samples = pending_.samples[pending_.count];
    ptrdiff_t& stride = pending_.strides[pending_.count];
    place(block, samples, stride);
    int16_t* coefficients = pending_.coefficients + 64 * pending_.count;
    const int last = read_coefficients<false>(scaled, -1, coefficients);
    if (last == 0) {
      picture_.kernels->idct_dc_add(coefficients[0], samples, stride);
      coefficients[0] = 0;
      continue;
    }
    ++pending_.count;
    good = last > 0 || (error_ == nullptr && fail("coded block without coefficients"));
  }
  if (good) picture_.kernels->idct_add(pending_.coefficients, pending_.count, pending_.samples, pending_.strides);
  clear_blocks(pending_.coefficients, pending_.count);
  return good;
}

bool SliceReader::read_macroblock() {
  int address = 0;
  if (!read_address(address)) return false;
  const bool is_first = flags_ == 0;  // the increment of a slice's first macroblock only says where it is
  if (address > address_ + 1 && !is_first && !skip_macroblocks(address_ + 1, address)) return false;
  address_ = address;
  row_ = address / picture_.columns, column_ = address % picture_.columns;

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
  return read_coded_blocks(pattern.value);
}

}  // namespace pac::mpeg1
