#include "mpeg1/headers.h"

#include "base/bits.h"
#include "base/kernels/block_kernels.h"

namespace pac::mpeg1 {

constexpr QuantizerMatrix kDefaultIntraMatrix = {8,  16, 19, 22, 26, 27, 29, 34, 16, 16, 22, 24, 27, 29, 34, 37,
                                                 19, 22, 26, 27, 29, 34, 34, 38, 22, 22, 26, 27, 29, 34, 37, 40,
                                                 22, 26, 27, 29, 32, 35, 40, 48, 26, 27, 29, 32, 35, 40, 48, 58,
                                                 26, 27, 29, 34, 38, 46, 56, 69, 27, 29, 35, 38, 46, 56, 69, 83};

namespace {

constexpr QuantizerMatrix flat(uint8_t value) {
  QuantizerMatrix matrix{};
  for (uint8_t& entry : matrix) entry = value;
  return matrix;
}

Failure failure(const BitReader& bits, Error error, const char* text) {
  return {bits.overrun() ? Error::truncated : error, bits.byte_offset(), bits.overrun() ? "header ends early" : text};
}

// In zigzag order [2.4.3.2]. False: an entry is zero.
bool parse_matrix(BitReader& bits, QuantizerMatrix& matrix) {
  bool good = true;
  for (const uint8_t natural : kNaturalFromZigzag) {
    matrix[natural] = static_cast<uint8_t>(bits.read(8));
    good = good && matrix[natural] != 0;
  }
  return good;
}

void write_matrix(BitWriter& bits, bool present, const QuantizerMatrix& matrix) {
  bits.put(present ? 1 : 0, 1);
  if (!present) return;
  for (const uint8_t natural : kNaturalFromZigzag) bits.put(matrix[natural], 8);
}

void append(BitWriter& bits, std::vector<uint8_t>& out) {
  const std::vector<uint8_t> bytes = bits.take();
  out.insert(out.end(), bytes.begin(), bytes.end());
}

}  // namespace

constexpr QuantizerMatrix kDefaultNonIntraMatrix = flat(16);

Result<SequenceHeader> parse_sequence_header(std::span<const uint8_t> bytes) {
  BitReader bits(bytes);
  SequenceHeader header;
  header.width = static_cast<int>(bits.read(12));
  header.height = static_cast<int>(bits.read(12));
  header.pel_aspect_ratio_code = static_cast<int>(bits.read(4));
  header.picture_rate_code = static_cast<int>(bits.read(4));
  header.bit_rate = static_cast<int>(bits.read(18));
  const bool marker = bits.read_flag();
  header.vbv_buffer_size = static_cast<int>(bits.read(10));
  header.constrained_parameters = bits.read_flag();
  if (bits.overrun()) return failure(bits, Error::truncated, "");
  if (header.width == 0 || header.height == 0) return failure(bits, Error::corrupt, "picture size is zero");
  if (header.height > kMaxHeight) return failure(bits, Error::unsupported, "more than 175 slice rows");
  if (header.pel_aspect_ratio_code == 0 || header.pel_aspect_ratio_code == 15)
    return failure(bits, Error::corrupt, "forbidden pel_aspect_ratio");
  if (header.picture_rate_code == 0 || header.picture_rate_code > 8)
    return failure(bits, Error::corrupt, "forbidden picture_rate");
  if (header.bit_rate == 0) return failure(bits, Error::corrupt, "bit_rate is zero");
  if (!marker) return failure(bits, Error::corrupt, "marker bit is zero");
  header.has_intra_matrix = bits.read_flag();
  if (header.has_intra_matrix && !parse_matrix(bits, header.intra_matrix))
    return failure(bits, Error::corrupt, "intra matrix has a zero");
  header.has_non_intra_matrix = bits.read_flag();
  if (header.has_non_intra_matrix && !parse_matrix(bits, header.non_intra_matrix))
    return failure(bits, Error::corrupt, "non-intra matrix has a zero");
  if (bits.overrun()) return failure(bits, Error::truncated, "");
  return header;
}

Result<GroupHeader> parse_group_header(std::span<const uint8_t> bytes) {
  BitReader bits(bytes);
  GroupHeader header;
  header.drop_frame = bits.read_flag();
  header.hours = static_cast<int>(bits.read(5));
  header.minutes = static_cast<int>(bits.read(6));
  const bool marker = bits.read_flag();
  header.seconds = static_cast<int>(bits.read(6));
  header.pictures = static_cast<int>(bits.read(6));
  header.closed = bits.read_flag();
  header.broken_link = bits.read_flag();
  if (bits.overrun()) return failure(bits, Error::truncated, "");
  if (!marker) return failure(bits, Error::corrupt, "marker bit is zero");
  return header;
}

Result<PictureHeader> parse_picture_header(std::span<const uint8_t> bytes) {
  BitReader bits(bytes);
  PictureHeader header;
  header.temporal_reference = static_cast<int>(bits.read(10));
  const uint32_t type = bits.read(3);
  header.vbv_delay = static_cast<int>(bits.read(16));
  if (bits.overrun()) return failure(bits, Error::truncated, "");
  if (type < 1 || type > 4) return failure(bits, Error::corrupt, "forbidden picture_coding_type");
  header.type = static_cast<PictureType>(type);
  if (header.type == PictureType::P || header.type == PictureType::B) {
    header.full_pel_forward = bits.read_flag();
    header.forward_f_code = static_cast<int>(bits.read(3));
  }
  if (header.type == PictureType::B) {
    header.full_pel_backward = bits.read_flag();
    header.backward_f_code = static_cast<int>(bits.read(3));
  }
  if (bits.overrun()) return failure(bits, Error::truncated, "");
  if (header.forward_f_code == 0 || header.backward_f_code == 0) return failure(bits, Error::corrupt, "f_code is zero");
  while (bits.read_flag()) {  // extra_information_picture; past the end there are only zeros
    bits.skip(8);
    if (bits.overrun()) return failure(bits, Error::truncated, "");
  }
  if (bits.overrun()) return failure(bits, Error::truncated, "");
  return header;
}

void write_start_code(uint8_t code, std::vector<uint8_t>& out) {
  out.insert(out.end(), {0, 0, 1, code});
}

void write_sequence_header(const SequenceHeader& header, std::vector<uint8_t>& out) {
  write_start_code(kSequenceHeader, out);
  BitWriter bits;
  bits.put(static_cast<uint32_t>(header.width), 12);
  bits.put(static_cast<uint32_t>(header.height), 12);
  bits.put(static_cast<uint32_t>(header.pel_aspect_ratio_code), 4);
  bits.put(static_cast<uint32_t>(header.picture_rate_code), 4);
  bits.put(static_cast<uint32_t>(header.bit_rate), 18);
  bits.put(1, 1);
  bits.put(static_cast<uint32_t>(header.vbv_buffer_size), 10);
  bits.put(header.constrained_parameters ? 1 : 0, 1);
  write_matrix(bits, header.has_intra_matrix, header.intra_matrix);
  write_matrix(bits, header.has_non_intra_matrix, header.non_intra_matrix);
  append(bits, out);
}

void write_group_header(const GroupHeader& header, std::vector<uint8_t>& out) {
  write_start_code(kGroupStart, out);
  BitWriter bits;
  bits.put(header.drop_frame ? 1 : 0, 1);
  bits.put(static_cast<uint32_t>(header.hours), 5);
  bits.put(static_cast<uint32_t>(header.minutes), 6);
  bits.put(1, 1);
  bits.put(static_cast<uint32_t>(header.seconds), 6);
  bits.put(static_cast<uint32_t>(header.pictures), 6);
  bits.put(header.closed ? 1 : 0, 1);
  bits.put(header.broken_link ? 1 : 0, 1);
  append(bits, out);
}

void write_picture_header(const PictureHeader& header, std::vector<uint8_t>& out) {
  write_start_code(kPictureStart, out);
  BitWriter bits;
  bits.put(static_cast<uint32_t>(header.temporal_reference), 10);
  bits.put(static_cast<uint32_t>(header.type), 3);
  bits.put(static_cast<uint32_t>(header.vbv_delay), 16);
  if (header.type == PictureType::P || header.type == PictureType::B) {
    bits.put(header.full_pel_forward ? 1 : 0, 1);
    bits.put(static_cast<uint32_t>(header.forward_f_code), 3);
  }
  if (header.type == PictureType::B) {
    bits.put(header.full_pel_backward ? 1 : 0, 1);
    bits.put(static_cast<uint32_t>(header.backward_f_code), 3);
  }
  bits.put(0, 1);  // extra_bit_picture
  append(bits, out);
}

bool is_constrained(const SequenceHeader& header) {
  const int64_t macroblocks = int64_t{macroblock_columns(header.width)} * macroblock_rows(header.height);
  const int rate = kPictureRatesMilli[header.picture_rate_code];
  return header.width <= 768 && header.height <= 576 && macroblocks <= 396 && macroblocks * rate <= 396 * 25 * 1000 &&
         rate <= 30000 && header.vbv_buffer_size <= 20 && header.bit_rate <= 4640;  // 1.856 Mb/s
}

}  // namespace pac::mpeg1
