// Marker segments of any JPEG file, read in syntax order [T.81 B.2]: everything that is not entropy-coded data.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/result.h"
#include "jpeg/frame.h"
#include "jpeg/huffman.h"
#include "jpeg/jpeg.h"
#include "jpeg/progressive.h"

namespace pac::jpeg {

struct ScanHeader {
  int n_components = 0;  // Ns; 0: the file's EOI came instead of another scan
  struct {
    int index = 0;                       // into frame.components
    uint8_t dc_table = 0, ac_table = 0;  // Td, Ta
  } components[kMaxComponents];
  Progression progression;   // of a sequential scan: everything at once
  uint64_t offset = 0;       // of the SOS marker
  uint64_t data_offset = 0;  // of the entropy-coded data behind it
};

// Tables that stay from file to file of a stream [T.81 B.5].
struct TableState {
  std::array<std::optional<QuantTable>, 4> quant_tables;
  HuffmanSpec huffman[2][4];  // [class: 0 DC, 1 AC][destination]
  bool have_huffman[2][4] = {};
  bool any_dht = false;
};

// State that segments leave behind.
struct Headers {
  Info info;  // `unsupported` set as soon as a segment says so
  Frame frame;
  bool have_frame = false;
  uint64_t frame_offset = 0;
  TableState tables;  // its quant_tables are those of `info`, too
  bool is_progressive() const { return info.start_of_frame == 0xC2; }
  int warnings = 0;  // bytes between segments that are no segment
};

class HeaderReader {
 public:
  HeaderReader(std::span<const uint8_t> bytes, const Limits& limits) : bytes_(bytes), limits_(limits) {}

  // Before start(): tables from earlier files.
  void inherit(const TableState& tables);
  // SOI: once, first.
  Result<void> start();
  // Segments up to and with the next SOS, or EOI. Call again with the position behind the scan's data.
  Result<ScanHeader> next_scan();
  // Instead of next_scan(): segments up to EOI, of which none may be a frame or a scan.
  Result<void> read_tables_only();

  void set_position(uint64_t offset) { position_ = offset; }
  const Headers& headers() const { return headers_; }

 private:
  struct Segment {
    std::span<const uint8_t> data;  // without marker and length
    uint64_t offset = 0;            // of data in the file
    int u8(size_t i) const { return data[i]; }
    int u16(size_t i) const { return data[i] << 8 | data[i + 1]; }
  };

  Result<int> next_marker();
  Result<Segment> segment();
  Result<void> read_segment(int code);
  Result<void> read_dqt(const Segment& s);
  Result<void> read_dht(const Segment& s);
  Result<void> read_dri(const Segment& s);
  Result<void> read_sof(int code, const Segment& s);
  Result<void> check_frame(const Segment& s);
  Result<ScanHeader> read_sos(const Segment& s);
  Result<void> read_progression(const Segment& s, ScanHeader& scan) const;
  void read_app(int code, const Segment& s);
  void finish_info();

  std::span<const uint8_t> bytes_;
  Limits limits_;
  uint64_t position_ = 0;
  uint64_t marker_offset_ = 0;
  bool in_first_headers_ = true;  // before the first SOS: markers are recorded
  Headers headers_;
};

}  // namespace pac::jpeg
