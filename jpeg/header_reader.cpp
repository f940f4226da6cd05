#include "jpeg/header_reader.h"

#include <cstring>

#include "base/kernels/block_kernels.h"
#include "jpeg/exif.h"
#include "jpeg/markers.h"
#include "jpeg/quality.h"

namespace pac::jpeg {
namespace {

Failure corrupt(uint64_t offset, const char* text) {
  return {Error::corrupt, offset, text};
}

bool starts_with(std::span<const uint8_t> data, std::span<const char> text) {
  return data.size() >= text.size() && std::memcmp(data.data(), text.data(), text.size()) == 0;
}

// Why a process other than baseline, 8-bit extended sequential and progressive
// with Huffman coding is refused [T.81 table B.1].
const char* unsupported_process(int code) {
  switch (code) {
    case kSof0:
    case kSof1:
    case kSof2:
      return nullptr;
    case kSof3:
      return "lossless JPEG (SOF3) is not supported";
    default:
      return code >= kSof9 ? "arithmetic-coded JPEG (SOF9..SOF15) is not supported"
                           : "hierarchical JPEG (SOF5..SOF7) is not supported";
  }
}

// The IJG software's rule (default_decompress_parms): JFIF means YCbCr, then Adobe's transform, then component ids.
ColorModel color_model(const Frame& frame, bool jfif, int adobe_transform) {
  const Component* c = frame.components;
  switch (frame.n_components) {
    case 1:
      return ColorModel::gray;
    case 3:
      if (jfif) return ColorModel::ycc;
      if (adobe_transform >= 0) return adobe_transform == 0 ? ColorModel::rgb : ColorModel::ycc;
      return c[0].id == 'R' && c[1].id == 'G' && c[2].id == 'B' ? ColorModel::rgb : ColorModel::ycc;
    case 4:
      return adobe_transform > 0 ? ColorModel::ycck : ColorModel::cmyk;
    default:
      return ColorModel::unknown;
  }
}

}  // namespace

void HeaderReader::inherit(const TableState& tables) {
  headers_.tables = tables;
  headers_.info.quant_tables = tables.quant_tables;
}

Result<void> HeaderReader::start() {
  if (bytes_.empty()) return Failure{Error::truncated, 0, "empty file"};
  if (bytes_[0] != 0xFF || (bytes_.size() > 1 && bytes_[1] != kSoi)) return corrupt(0, "not a JPEG file: no SOI");
  if (bytes_.size() < 2) return Failure{Error::truncated, 1, "file ends inside SOI"};
  position_ = 2;
  headers_.info.markers.push_back({kSoi, 0, 0});
  return {};
}

// The next marker's code; position_ behind it. Any number of 0xFF may stand before the code [T.81 B.1.1.2]. Bytes that
// belong to no segment are skipped and counted, as the IJG software does.
Result<int> HeaderReader::next_marker() {
  bool junk = false;
  while (position_ < bytes_.size()) {
    if (bytes_[position_] != 0xFF) {
      junk = true;
      ++position_;
      continue;
    }
    marker_offset_ = position_;
    while (position_ < bytes_.size() && bytes_[position_] == 0xFF) ++position_;
    if (position_ == bytes_.size()) break;
    const int code = bytes_[position_++];
    if (code != 0) {
      headers_.warnings += junk ? 1 : 0;
      return code;
    }
    junk = true;
  }
  return Failure{Error::truncated, bytes_.size(), "file ends where a marker is due"};
}

Result<HeaderReader::Segment> HeaderReader::segment() {
  if (bytes_.size() - position_ < 2)
    return Failure{Error::truncated, bytes_.size(), "file ends inside a segment length"};
  const auto length = static_cast<uint64_t>(bytes_[position_] << 8 | bytes_[position_ + 1]);
  if (length < 2) return corrupt(position_, "segment length below 2");
  if (bytes_.size() - position_ < length) return Failure{Error::truncated, bytes_.size(), "file ends inside a segment"};
  const Segment segment{bytes_.subspan(position_ + 2, length - 2), position_ + 2};
  position_ += length;
  if (in_first_headers_)
    headers_.info.markers.push_back({bytes_[segment.offset - 3], marker_offset_, static_cast<uint32_t>(length - 2)});
  return segment;
}

Result<ScanHeader> HeaderReader::next_scan() {
  for (;;) {
    PAC_TRY(const int code, next_marker());
    if (code == kEoi) {
      if (in_first_headers_) return corrupt(marker_offset_, "EOI before any scan");
      return ScanHeader{};
    }
    if (code == kSoi) return corrupt(marker_offset_, "second SOI");
    if (is_restart(code) || code == kTem) continue;  // no parameters; stray here, but harmless
    if (code == kSos) {
      PAC_TRY(const Segment s, segment());
      return read_sos(s);
    }
    PAC_CHECK(read_segment(code));
  }
}

Result<void> HeaderReader::read_tables_only() {
  for (;;) {
    PAC_TRY(const int code, next_marker());
    if (code == kEoi) return {};
    if (code == kSoi) return corrupt(marker_offset_, "second SOI");
    if (code == kSos || is_start_of_frame(code)) return corrupt(marker_offset_, "an image where only tables are due");
    if (!is_restart(code) && code != kTem) PAC_CHECK(read_segment(code));
  }
}

Result<void> HeaderReader::read_segment(int code) {
  const uint64_t offset = marker_offset_;
  PAC_TRY(const Segment s, segment());
  if (is_start_of_frame(code)) return read_sof(code, s);
  switch (code) {
    case kDqt:
      return read_dqt(s);
    case kDht:
      return read_dht(s);
    case kDri:
      return read_dri(s);
    case kDnl:
      return Failure{Error::unsupported, offset, "DNL (number of lines after the scan) is not supported"};
    case kDhp:
    case kExp:
      return Failure{Error::unsupported, offset, "hierarchical JPEG (DHP, EXP) is not supported"};
    default:
      if (code == kCom || (code & 0xF0) == 0xE0) {
        read_app(code, s);
        return {};
      }
      // DAC has no effect without arithmetic coding; JPG, JPGn and RES are reserved.
      if (code == kDac) return {};
      return corrupt(offset, "reserved marker");
  }
}

Result<void> HeaderReader::read_dqt(const Segment& s) {
  for (size_t i = 0; i < s.data.size();) {
    const int precision = s.u8(i) >> 4, id = s.u8(i) & 15;
    if (precision > 1) return corrupt(s.offset + i, "DQT: element precision is neither 8 nor 16 bits");
    if (id > 3) return corrupt(s.offset + i, "DQT: table destination above 3");
    i += 1;
    const size_t step_bytes = precision == 0 ? 1 : 2;
    if (s.data.size() - i < 64 * step_bytes) return corrupt(s.offset + i, "DQT: segment too short for its table");
    QuantTable table;
    for (const uint8_t natural : kNaturalFromZigzag) {
      const int step = precision == 0 ? s.u8(i) : s.u16(i);
      if (step == 0) return corrupt(s.offset + i, "DQT: quantizer step 0");
      table[natural] = static_cast<uint16_t>(step);
      i += step_bytes;
    }
    headers_.info.quant_tables[static_cast<size_t>(id)] = headers_.tables.quant_tables[static_cast<size_t>(id)] = table;
  }
  return {};
}

Result<void> HeaderReader::read_dht(const Segment& s) {
  headers_.tables.any_dht = headers_.tables.any_dht || !s.data.empty();
  for (size_t i = 0; i < s.data.size();) {
    const int table_class = s.u8(i) >> 4, id = s.u8(i) & 15;
    if (table_class > 1) return corrupt(s.offset + i, "DHT: table class above 1");
    if (id > 3) return corrupt(s.offset + i, "DHT: table destination above 3");
    if (s.data.size() - i < 17) return corrupt(s.offset + i, "DHT: segment too short for its code counts");
    HuffmanSpec spec;
    std::memcpy(spec.count + 1, s.data.data() + i + 1, 16);
    const int n = spec.n_symbols();
    if (n > 256) return corrupt(s.offset + i, "DHT: more than 256 codes");
    if (!is_valid(spec)) return corrupt(s.offset + i, "DHT: more codes of a length than are possible");
    i += 17;
    if (s.data.size() - i < static_cast<size_t>(n))
      return corrupt(s.offset + i, "DHT: segment too short for its symbols");
    if (n > 0) std::memcpy(spec.symbols, s.data.data() + i, static_cast<size_t>(n));
    for (int k = 0; table_class == 0 && k < n; ++k)
      if (spec.symbols[k] > 15) return corrupt(s.offset + i, "DHT: DC category above 15");
    i += static_cast<size_t>(n);
    headers_.tables.huffman[table_class][id] = spec;
    headers_.tables.have_huffman[table_class][id] = true;
  }
  return {};
}

Result<void> HeaderReader::read_dri(const Segment& s) {
  if (s.data.size() != 2) return corrupt(s.offset, "DRI: segment length is not 4");
  headers_.info.restart_interval_mcus = s.u16(0);
  return {};
}

Result<void> HeaderReader::read_sof(int code, const Segment& s) {
  if (headers_.have_frame) return corrupt(marker_offset_, "second SOF");
  if (s.data.size() < 6) return corrupt(s.offset, "SOF: segment too short");
  Info& info = headers_.info;
  Frame& frame = headers_.frame;
  info.start_of_frame = static_cast<uint8_t>(code);
  info.precision_bits = s.u8(0);
  info.height = frame.height = s.u16(1);
  info.width = frame.width = s.u16(3);
  const int n = s.u8(5);
  if (n == 0) return corrupt(s.offset + 5, "SOF: no components");
  if (s.data.size() != static_cast<size_t>(6 + 3 * n))
    return corrupt(s.offset + 5, "SOF: length does not fit the components");
  headers_.have_frame = true;
  headers_.frame_offset = marker_offset_;
  info.unsupported = unsupported_process(code);
  if (n > kMaxComponents) {
    info.unsupported = "more than 4 components are not supported";
    return {};
  }
  frame.n_components = n;
  for (int i = 0; i < n; ++i) {
    const size_t at = 6 + 3 * static_cast<size_t>(i);
    Component& c = frame.components[i];
    c.id = static_cast<uint8_t>(s.u8(at));
    c.h = static_cast<uint8_t>(s.u8(at + 1) >> 4);
    c.v = static_cast<uint8_t>(s.u8(at + 1) & 15);
    c.quant_table = static_cast<uint8_t>(s.u8(at + 2));
    info.components.push_back({c.id, c.h, c.v, c.quant_table});
  }
  return check_frame(s);
}

Result<void> HeaderReader::check_frame(const Segment& s) {
  Info& info = headers_.info;
  Frame& frame = headers_.frame;
  if (info.precision_bits != 8) {
    const bool legal = info.start_of_frame == kSof3 || (info.precision_bits == 12 && info.start_of_frame != kSof0);
    if (!legal) return corrupt(s.offset, "SOF: sample precision is not 8 bits");
    if (info.unsupported == nullptr) info.unsupported = "12-bit JPEG is not supported";
  }
  if (frame.width == 0) return corrupt(s.offset + 3, "SOF: width 0");
  for (int i = 0; i < frame.n_components; ++i) {
    const uint64_t at = s.offset + 6 + 3 * static_cast<uint64_t>(i);
    const Component& c = frame.components[i];
    if (c.h < 1 || c.h > 4 || c.v < 1 || c.v > 4) return corrupt(at + 1, "SOF: sampling factor outside 1..4");
    if (c.quant_table > 3) return corrupt(at + 2, "SOF: quantization table above 3");
    for (int j = 0; j < i; ++j)
      if (frame.components[j].id == c.id) return corrupt(at, "SOF: component id used twice");
  }
  if (frame.height == 0) {
    if (info.unsupported == nullptr) info.unsupported = "height 0 (defined by DNL) is not supported";
    return {};
  }
  if (frame.n_components == 2 && info.unsupported == nullptr) info.unsupported = "two components have no color meaning";
  if (info.unsupported != nullptr) return {};  // nothing will be allocated
  if (static_cast<uint64_t>(frame.width) * static_cast<uint64_t>(frame.height) > limits_.max_pixels)
    return Failure{Error::limit_exceeded, s.offset, "image has more pixels than the limit"};
  finish_frame(frame);
  return {};
}

Result<ScanHeader> HeaderReader::read_sos(const Segment& s) {
  if (!headers_.have_frame) return corrupt(marker_offset_, "SOS before SOF");
  if (in_first_headers_) finish_info();
  in_first_headers_ = false;
  ScanHeader scan;
  scan.offset = marker_offset_;
  scan.data_offset = position_;
  if (headers_.info.unsupported != nullptr) return scan;  // its rules are not ours to check
  if (s.data.empty()) return corrupt(s.offset, "SOS: segment too short");
  const int n = s.u8(0);
  if (n < 1 || n > 4) return corrupt(s.offset, "SOS: component count outside 1..4");
  if (s.data.size() != static_cast<size_t>(4 + 2 * n))
    return corrupt(s.offset, "SOS: length does not fit the components");
  const Frame& frame = headers_.frame;
  int blocks_in_mcu = 0;
  for (int i = 0; i < n; ++i) {
    const size_t at = 1 + 2 * static_cast<size_t>(i);
    int index = 0;
    while (index < frame.n_components && frame.components[index].id != s.u8(at)) ++index;
    if (index == frame.n_components) return corrupt(s.offset + at, "SOS: component is not in the frame");
    for (int j = 0; j < i; ++j)
      if (scan.components[j].index == index) return corrupt(s.offset + at, "SOS: component named twice");
    scan.components[i] = {index, static_cast<uint8_t>(s.u8(at + 1) >> 4), static_cast<uint8_t>(s.u8(at + 1) & 15)};
    if (scan.components[i].dc_table > 3 || scan.components[i].ac_table > 3)
      return corrupt(s.offset + at + 1, "SOS: Huffman table above 3");
    blocks_in_mcu += frame.components[index].h * frame.components[index].v;
  }
  if (n > 1 && blocks_in_mcu > kMaxBlocksInMcu) return corrupt(s.offset, "SOS: more than 10 blocks in an MCU");
  scan.n_components = n;
  PAC_CHECK(read_progression(s, scan));
  return scan;
}

// Ss, Se, Ah and Al, the last three bytes [T.81 B.2.3, G.1.1.1].
Result<void> HeaderReader::read_progression(const Segment& s, ScanHeader& scan) const {
  const size_t at = s.data.size() - 3;
  const int first = s.u8(at), last = s.u8(at + 1), high = s.u8(at + 2) >> 4, low = s.u8(at + 2) & 15;
  scan.progression = {first, last, high, low};
  if (!headers_.is_progressive()) {
    if (first == 0 && last == 63 && high == 0 && low == 0) return {};
    return corrupt(s.offset + at, "SOS: not a full sequential scan (Ss, Se, Ah, Al)");
  }
  const bool is_band = first == 0 ? last == 0 : first <= last && last <= 63 && scan.n_components == 1;
  if (!is_band) return corrupt(s.offset + at, "SOS: not a band of a progressive scan (Ss, Se)");
  if (low > 13 || (high != 0 && high != low + 1))
    return corrupt(s.offset + at + 2, "SOS: impossible bit positions of a progressive scan (Ah, Al)");
  return {};
}

void HeaderReader::read_app(int code, const Segment& s) {
  Info& info = headers_.info;
  if (code == kCom) {
    if (in_first_headers_) info.comments.push_back({s.offset, s.data.size()});
  } else if (code == kApp0 && s.data.size() >= 12 && starts_with(s.data, {"JFIF", 5})) {
    info.jfif = true;
    info.density_units = s.u8(7);
    info.density_x = s.u16(8);
    info.density_y = s.u16(10);
  } else if (code == kApp14 && s.data.size() >= 12 && starts_with(s.data, {"Adobe", 5})) {
    info.adobe_transform = s.u8(11);
  } else if (code == kApp1 && info.exif_orientation == 0 && starts_with(s.data, {"Exif\0", 6})) {
    info.exif_orientation = exif_orientation(s.data.subspan(6));
  } else if (code == kApp2 && starts_with(s.data, {"ICC_PROFILE", 12})) {
    info.has_icc_profile = true;
  }
}

void HeaderReader::finish_info() {
  Info& info = headers_.info;
  info.header_bytes = position_;
  info.default_huffman = !headers_.tables.any_dht;
  info.color = color_model(headers_.frame, info.jfif, info.adobe_transform);
}

Result<Info> read_info(std::span<const uint8_t> bytes, const Limits& limits) {
  HeaderReader reader(bytes, limits);
  PAC_CHECK(reader.start());
  PAC_CHECK(reader.next_scan());
  Info info = reader.headers().info;
  const uint8_t first_table = info.components.empty() ? 0 : info.components[0].quant_table & 3;
  if (info.quant_tables[first_table]) info.estimated_quality = estimate_quality(*info.quant_tables[first_table]);
  return info;
}

}  // namespace pac::jpeg
